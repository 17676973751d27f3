// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Masses and inertias of MJCF bodies: from <inertial>, or where there is none from their geoms.

#include <optional>

#include "describe/mjcf_settings.hpp"
#include "describe/robot_file.hpp"
#include "describe/solids.hpp"

namespace anholon {

class MjcfInertials : protected MjcfSettings {
 protected:
  using MjcfSettings::MjcfSettings;

  /// @param what  names the body; @param notes  takes what is assumed
  std::optional<RobotInertial> read_inertial(const XMLElement& body, const std::string& what,
                                             const std::string& childclass, std::vector<std::string>& notes);

 private:
  RobotInertial read_figures(const XMLElement& e, const std::string& what);
  std::optional<RobotInertial> from_geoms(const XMLElement& body, const std::string& what,
                                          const std::string& childclass, std::vector<std::string>& notes);
  /// Nothing where the geom has no mass, or is wrong.
  std::optional<PlacedSolid> read_geom(const XMLElement& e, const std::string& what,
                                       const std::string& childclass);
  std::optional<Solid> read_solid(const std::string& type, const MjcfAttributes& a, const std::string& what,
                                  const Location& where, PlacedSolid& placed);
};

}  // namespace anholon
