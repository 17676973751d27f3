// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The rigid snake-board in Simbody, behind an interface of plain numbers (see simbody_engine.hpp).

namespace anholon::bench {

/// kg, kg m^2, m; parameters of models/rigid_snakeboard.
struct SnakeboardFigures {
  double m_p = 0, J_p = 0, l = 0, m_a = 0, J_a = 0, J_h = 0, J_r = 0;
};

/// Pose of the platform in the plane, and its twist in its own axes.
struct SnakeboardEnd {
  double theta = 0, x = 0, y = 0, V_X = 0, V_Y = 0, Omega_Z = 0;
  double cpu_seconds = 0;  // of the integration alone
  long evaluations = 0;
};

/// Axles at +-0.5 sin(2.5 t), rotor at 0.7 cos(2.5 t), from rest but for V_X = 0.5 m/s, by
/// Runge-Kutta-Merson; wheels are NoSlip1D constraints, joints follow Motion::Sinusoid.
SnakeboardEnd simbody_snakeboard(const SnakeboardFigures& figures, double duration, double accuracy);

}  // namespace anholon::bench
