// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Everything that `evaluate` answers at one state, however it was computed. Velocities, forces and matrices
// are over (eta, r_dot) with r in declared order; the formatter brings them into the order that the caller
// asked for.

#include <string>
#include <vector>

#include "anholon/matrix.hpp"
#include "anholon/mechanism.hpp"

namespace anholon {

/// Inputs at one state.
template <class S>
struct EvaluationInput {
  State<S> state;              // with admissible velocities
  std::vector<S> r_ddot;       // (s) second derivatives; only those of active coordinates are used
  std::vector<S> tau;          // (s) torques of active coordinates
  std::vector<S> lambda_stat;  // (rows - m°) static loading with the motion given; empty: none
  bool has_acceleration = false;
  bool has_torque = false;
};

template <class S>
struct Evaluated {
  Matrix<S> M;                       // (n + s)^2
  std::vector<S> force;              // (f, Q), n + s
  Matrix<S> G;                       // (A, B), rows x (n + s)
  std::vector<S> bias;               // rows
  Matrix<S> projector;               // onto ker (A, B_p), passive x passive in the partition's order
  std::vector<S> acceleration;       // given r_a_ddot, n + s
  std::vector<S> lambda;             // rows
  bool least_norm = true;            // of all lambda; else the leading rows carry them
  std::vector<S> tau_a;              // active, partition's order
  std::vector<S> free_acceleration;  // given tau_a, n + s
  std::vector<S> free_lambda;        // rows
  S kinetic = S(0), gravity = S(0), elastic = S(0), dissipated_power = S(0);
  // reduced quantities in the program's basis; empty where the evaluation is basis-free
  Matrix<S> H, J, M_r;
  std::vector<S> f_r, nu, nu_dot;
  std::string basis;
};

}  // namespace anholon
