// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace anholon::bench {

/// The gait of the rigid snake-board by generated code, by the recursion, and by Simbody with its own no-slip
/// constraints and prescribed joints, as a record of the report's kind.
/// @param scene  models/rigid_snakeboard/gait.scene.toml: Simbody's motors follow the same sines
nlohmann::ordered_json snakeboard_motion(const std::string& scene);

}  // namespace anholon::bench
