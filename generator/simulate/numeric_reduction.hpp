// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Factorisations of the numeric reduction in double: accelerations at a state, and velocities that
// constraints leave open.

#include <vector>

#include "anholon/free_dynamics.hpp"
#include "reduce/decompositions.hpp"
#include "reduce/partition.hpp"

namespace anholon {

/// Accelerations of the passive velocities under the rows, by sweeps of the recursion and an orthonormal
/// kernel.
/// @param active  (s_a) accelerations of the active ones     @param applied  (n + s) forces besides those of
/// the model
DynamicVector<double> passive_accelerations(FreeDynamics<double>& dynamics, const State<double>& state,
                                            const Partition& partition, const DynamicVector<double>& active,
                                            const DynamicVector<double>& applied);

/// Minimum-norm least-squares solution of A x = b.
DynamicVector<double> least_norm(const DynamicMatrix<double>& A, const DynamicVector<double>& b);

}  // namespace anholon
