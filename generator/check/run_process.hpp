// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace anholon {

/// Runs a program without a shell; what it prints, also its errors, goes to a file.
/// @return its exit status, 128 + signal if one ended it
/// @throws std::system_error if it cannot be started
int run_process(const std::vector<std::string>& command, const std::filesystem::path& printed);

}  // namespace anholon
