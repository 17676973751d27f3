// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A model file that stands on a URDF file and adds what URDF has no words for: the group of net motions,
// which joints are passive, springs, couplings, contacts, forces and compliant bodies. docs/urdf.md documents
// its keys.

#include <string>
#include <string_view>

#include "describe/document.hpp"
#include "describe/read_model.hpp"

namespace anholon {

/// @param document  of the file, with the key 'urdf'; @param text  its bytes
/// @throws ModelError with everything that is wrong with it, or with the URDF file
Model read_supplemented_urdf(const Value& document, std::string_view text, const std::string& file_name,
                             const ParameterValues& overrides);

}  // namespace anholon
