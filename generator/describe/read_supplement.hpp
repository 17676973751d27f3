// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A model file that stands on a robot file and adds what its format has no words for: the group of net
// motions, which joints are passive, springs, couplings, contacts, forces and compliant bodies.
// docs/robot-files.md documents its keys.

#include <array>
#include <string>
#include <string_view>

#include "describe/document.hpp"
#include "describe/read_model.hpp"

namespace anholon {

/// The keys that name the robot's file, by format; a description that has one of them is a supplement.
inline constexpr std::array<const char*, 3> supplement_keys = {"urdf", "sdf", "mjcf"};

/// @param document  of the file, with one of `supplement_keys`; @param text  its bytes
/// @throws ModelError with everything that is wrong with it, or with the robot file
Model read_supplemented_robot(const Value& document, std::string_view text, const std::string& file_name,
                              const ParameterValues& overrides);

}  // namespace anholon
