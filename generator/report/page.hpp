// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace anholon {

/// A self-contained HTML page of a report: tables, and plots by gnuplot within the page.
/// @param report  schema anholon.report/1: the machine, the records of models and of motions
/// @throws PlotError
std::string report_page(const nlohmann::ordered_json& report);

/// CPU time that a code of a motion needs for an error, by straight lines between the logarithms of its
/// points; not a number where its ladder does not reach so far. @param code  "generated" or "recursion"
double cpu_seconds_at(const nlohmann::ordered_json& motion, const std::string& code, double error);

}  // namespace anholon
