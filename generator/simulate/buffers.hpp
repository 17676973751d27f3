// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Every array that the functions of a scene read or write, by the name of its block.

#include <map>
#include <string>
#include <vector>

namespace anholon {

template <class S>
class Buffers {
 public:
  Buffers() = default;
  Buffers(const Buffers&) = delete;  // the references below are to its own blocks
  Buffers& operator=(const Buffers&) = delete;
  ~Buffers() = default;

  std::vector<S>& operator[](const std::string& block) { return blocks_[block]; }

 private:
  using Block = std::vector<S>&;
  std::map<std::string, std::vector<S>> blocks_;

 public:
  Block t = blocks_["t"], g = blocks_["g"], R = blocks_["R"], p = blocks_["p"];
  Block r_p = blocks_["r_p"], r_a = blocks_["r_a"], r_p_dot = blocks_["r_p_dot"],
        r_a_dot = blocks_["r_a_dot"], r_d_dot = blocks_["r_d_dot"], r_a_ddot = blocks_["r_a_ddot"];
  Block eta = blocks_["eta"], nu = blocks_["nu"], nu_dot = blocks_["nu_dot"];
  Block r_a_dddot = blocks_["r_a_dddot"], r_m_dddot = blocks_["r_m_dddot"];
  Block rates_x = blocks_["rates_x"], rates_t = blocks_["rates_t"], power_x = blocks_["power_x"],
        power_t = blocks_["power_t"];
  Block r_m = blocks_["r_m"], r_m_dot = blocks_["r_m_dot"], r_m_ddot = blocks_["r_m_ddot"];
  Block torque = blocks_["torque"], tau_a = blocks_["tau_a"], tau_d = blocks_["tau_d"],
        lambda = blocks_["lambda"];
  Block kinetic = blocks_["kinetic"], gravity = blocks_["gravity"], elastic = blocks_["elastic"],
        dissipated_power = blocks_["dissipated_power"], applied_power = blocks_["applied_power"];
  Block A = blocks_["A"], B_p = blocks_["B_p"], B_a = blocks_["B_a"], bias = blocks_["bias"],
        lambda_stat_basis = blocks_["lambda_stat_basis"];
  Block velocity_residual = blocks_["velocity_residual"],
        acceleration_residual = blocks_["acceleration_residual"];
  Block Phi = blocks_["Phi"], Phi_q = blocks_["Phi_q"];
  Block chart_quality = blocks_["quality"];
};

}  // namespace anholon
