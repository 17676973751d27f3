// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/function_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <stdexcept>

namespace anholon {

const std::vector<std::string>& function_names() {
  static const std::vector<std::string> names = {"kinematics",
                                                 "reduced_velocities",
                                                 "constraints",
                                                 "free_dynamics",
                                                 "reduced_dynamics",
                                                 "split_dynamics",
                                                 "forward_dynamics",
                                                 "state_jacobian",
                                                 "inverse_torques",
                                                 "multipliers",
                                                 "compatibility",
                                                 "torque_driven_kinematics",
                                                 "torque_driven_velocities",
                                                 "torque_driven_dynamics",
                                                 "torque_driven_multipliers",
                                                 "position_conditions",
                                                 "energies",
                                                 "body_poses"};
  return names;
}

void refuse_unknown_functions(const std::vector<std::string>& functions,
                              const std::vector<std::string>& known) {
  for (const std::string& name : functions) {
    if (std::ranges::find(known, name) == known.end())
      throw std::invalid_argument(
          fmt::format("there is no function '{}'; choose from {}", name, fmt::join(known, ", ")));
  }
}

}  // namespace anholon
