// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The state at t = 0: pose and coordinates as the scene gives them, velocities as the constraints rule them.

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "anholon/integrate/result.hpp"
#include "describe/specialise.hpp"
#include "reduce/decompositions.hpp"
#include "simulate/groups.hpp"
#include "simulate/position_keeper.hpp"
#include "simulate/runner.hpp"

namespace anholon {

/// What the velocities that are not named have to add so that A v = b holds; least norm.
/// @throws ModelError where the named ones do not leave a way
DynamicVector<double> completion(const Scene& scene, const SceneProgram& program,
                                 const DynamicMatrix<double>& A, const DynamicVector<double>& missing,
                                 const DynamicVector<double>& given, const std::vector<char>& named);

/// Passive velocities at the start: the named ones as given, the others as the constraints rule, least norm.
template <class S>
void initial_velocities(const Scene& scene, const SceneProgram& program, Runner<S>& run) {
  const std::vector<int> kept = kept_coordinates(scene.model, scene);
  const auto components = free_components(program.model.group);
  const Partition& p = program.reduced;
  const auto size = static_cast<Eigen::Index>(p.passive.size());
  DynamicVector<double> given = DynamicVector<double>::Zero(size);
  std::vector<char> named(p.passive.size(), 0);
  for (const auto& [index, value] : scene.initial.velocities) {
    int velocity = -1;
    if (index < 6) {
      const auto at = std::ranges::find(components, index);
      if (at != components.end()) velocity = static_cast<int>(at - components.begin());
    } else if (kept[static_cast<std::size_t>(index - 6)] >= 0) {
      velocity = p.n + kept[static_cast<std::size_t>(index - 6)];
    }
    const auto at = std::ranges::find(p.passive, velocity);
    if (at == p.passive.end()) continue;
    given(at - p.passive.begin()) = value.to_double();
    named[static_cast<std::size_t>(at - p.passive.begin())] = 1;
  }
  // Contacts that give way rest at the start; else they would take what the named velocities leave open.
  const std::size_t stiff = program.model.coordinates.size() - program.model.deflections;
  for (std::size_t i = 0; i < p.passive.size(); ++i) {
    if (p.passive[i] - p.n >= static_cast<int>(stiff)) named[i] = 1;
  }
  const auto rows = static_cast<Eigen::Index>(program.model.rows.size());
  if (rows > 0) {
    run.constraints();
    const auto entry = [&](Eigen::Index i, int velocity) {
      const int n = p.n;
      const auto cell = [&](const std::vector<S>& m, std::size_t cols, std::ptrdiff_t j) {
        return static_cast<double>(m[static_cast<std::size_t>(i) * cols + static_cast<std::size_t>(j)]);
      };
      if (velocity < n) return cell(run.b.A, static_cast<std::size_t>(n), velocity);
      const auto a = std::ranges::find(program.original.active, velocity);
      if (a != program.original.active.end())
        return cell(run.b.B_a, program.original.active.size(), a - program.original.active.begin());
      return cell(
          run.b.B_p, static_cast<std::size_t>(program.original.s_p()),
          std::ranges::find(program.original.passive, velocity) - program.original.passive.begin() - n);
    };
    DynamicMatrix<double> A(rows, size);
    DynamicVector<double> b = DynamicVector<double>::Zero(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (Eigen::Index j = 0; j < size; ++j) A(i, j) = entry(i, p.passive[static_cast<std::size_t>(j)]);
      for (std::size_t j = 0; j < p.active.size(); ++j)
        b(i) -= entry(i, p.active[j]) * static_cast<double>(run.b.r_a_dot[j]);
    }
    given += completion(scene, program, A, b - A * given, given, named);
  }
  std::size_t driven = 0;
  for (Eigen::Index i = 0; i < size; ++i) {
    if (i < p.n) {
      run.b.eta[static_cast<std::size_t>(i)] = S(given(i));
    } else if (i < p.n + program.original.s_p()) {
      run.b.r_p_dot[static_cast<std::size_t>(i - p.n)] = S(given(i));
    } else {
      run.b.r_d_dot[driven++] = S(given(i));
    }
  }
  if (run.reduced_velocities) run.reduced_velocities();
}

/// Moves a start that does not meet the conditions on the position to the nearest that does.
/// @throws ModelError where Newton's method finds none
template <class G>
void meet_position_conditions(const Scene& scene, const SceneProgram& program,
                              Runner<typename G::Scalar>& run, integrate::State<G>& state) {
  PositionKeeper<G> keeper(program, run);
  if (keeper.empty()) return;
  keeper.start(state.t, state.g, state.y);
  keeper(state.t, state.g, state.y);
  const auto left = static_cast<double>(keeper.residual(state.t, state.g, state.y));
  if (!(left <= 1e-12))  // m: far above rounding, far below what anybody could mean
    throw ModelError(
        scene.initial_where,
        fmt::format("no position near the initial one meets the contacts: {:.2g} m are left", left),
        "give an initial pose and coordinates at which they touch, or nearly so");
}

/// State at t = 0, in the chart that is best there, in which it leaves the runner; y has room for the
/// quadratures.
template <class G>
integrate::State<G> initial_state(const Scene& scene, const SceneProgram& program,
                                  Runner<typename G::Scalar>& run, int quadratures) {
  using S = typename G::Scalar;
  integrate::State<G> state;
  state.t = S(0);
  state.g = pose_of<G>(scene.initial);
  state.y.setZero(run.size() + quadratures);
  const std::vector<int> kept = kept_coordinates(scene.model, scene);
  const FromExact<S> real;
  for (const auto& [index, value] : scene.initial.coordinates) {
    const int velocity = kept[static_cast<std::size_t>(index)] + program.original.n;
    const auto at = std::ranges::find(program.reduced.passive, velocity);
    if (kept[static_cast<std::size_t>(index)] >= 0 && at != program.reduced.passive.end())
      state.y(at - program.reduced.passive.begin() - program.original.n) = real(value);
  }
  run.impose(S(0));
  run.start_at_wanted_motion(state.y);
  meet_position_conditions<G>(scene, program, run, state);
  run.impose(S(0));
  run.set(state.g, state.y);
  run.use_chart(run.best_chart_here());
  initial_velocities(scene, program, run);
  const Eigen::Index shape = run.size() - static_cast<Eigen::Index>(run.b.nu.size());
  for (std::size_t i = 0; i < run.b.nu.size(); ++i)
    state.y(shape + static_cast<Eigen::Index>(i)) = run.b.nu[i];
  return state;
}

}  // namespace anholon
