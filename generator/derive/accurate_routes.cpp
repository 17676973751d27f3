// SPDX-License-Identifier: GPL-2.0-or-later
// Accelerations where the mass matrix on the kernel's own basis is ill-conditioned. Derived only where the
// plain routes lose digits.
#include <algorithm>
#include <stdexcept>

#include "derive/deriver.hpp"
#include "optimise/accuracy/rounded.hpp"

namespace anholon {

std::pair<std::vector<Expr>, std::vector<Expr>> Deriver::solved_on_orthogonal_basis(
    const Reduced& of, const std::vector<Expr>& nu, const std::vector<Expr>& r_a_dot,
    const std::vector<Expr>& r_a_ddot, const std::vector<Expr>& input_force, bool project) {
  tape_.section("orthogonal basis");
  const OrthogonalBasis basis = orthogonal_basis(of.reduction->kernel().H);
  const ReducedDynamics d = reduced_dynamics(of, basis.Q, nu, r_a_dot, r_a_ddot, input_force, project);
  tape_.section("reduced accelerations");
  const std::vector<Expr> along = solve_symmetric(d.M_r, {d.f_r}).front();
  std::vector<Expr> nu_dot = basis.solve(along);
  tape_.section("accelerations");
  return {std::move(nu_dot), accelerations(of, basis.Q, d, along)};
}

std::vector<Deriver::UnitColumn> Deriver::modal_columns(const Reduced& of) const {
  const Matrix<Expr>& H = of.reduction->kernel().H;
  const std::vector<int>& passive = of.partition.passive;
  const auto entries = [](const std::vector<Expr>& v) {
    return std::ranges::count_if(v, [](const Expr& e) { return !e.is_zero(); });
  };
  std::vector<UnitColumn> result;
  for (const Body<Expr>& body : mechanism_.bodies) {
    for (const Mode<Expr>& mode : body.modes) {
      const auto place = std::ranges::find(passive, of.partition.n + mode.coordinate);
      if (place == passive.end()) continue;
      const int row = static_cast<int>(place - passive.begin());
      std::vector<Expr> in_row;
      for (int c = 0; c < H.cols(); ++c) in_row.push_back(H(row, c));
      if (entries(in_row) != 1) continue;
      const auto column =
          std::ranges::find_if(in_row, [](const Expr& e) { return !e.is_zero(); }) - in_row.begin();
      if (entries(column_of(H, static_cast<int>(column))) == 1)
        result.push_back({row, static_cast<int>(column)});
    }
  }
  return result;
}

std::pair<std::vector<Expr>, std::vector<Expr>> Deriver::solved_modes_first(
    const Reduced& of, const std::vector<Expr>& nu, const std::vector<Expr>& r_a_dot,
    const std::vector<Expr>& r_a_ddot, const std::vector<Expr>& input_force) {
  const Matrix<Expr>& H = of.reduction->kernel().H;
  const ReducedDynamics d = reduced_dynamics(of, H, nu, r_a_dot, r_a_ddot, input_force, true);
  const State<Expr> state = symbols_.moving(d.velocity);
  std::vector<int> modes, rows, others = range(H.cols());
  for (const UnitColumn& mode : modal_columns(of)) {
    modes.push_back(mode.column);
    rows.push_back(mode.row);
    std::erase(others, mode.column);
  }
  const auto size = [](const std::vector<int>& columns) { return static_cast<int>(columns.size()); };

  tape_.section("modes that follow");
  Matrix<Expr> m_rr(size(modes), size(modes));
  for (int j = 0; j < size(modes); ++j) {
    const std::vector<Expr> momenta =
        picked(mass_times(of.partition, state, column_of(H, modes[static_cast<std::size_t>(j)])), rows);
    for (int i = 0; i < size(modes); ++i) m_rr(i, j) = momenta[static_cast<std::size_t>(i)];
  }
  std::vector<std::vector<Expr>> sides = {picked(d.f_r, modes)};
  for (const int c : others) sides.push_back(picked(mass_times(of.partition, state, column_of(H, c)), rows));
  const auto follow =
      solve_symmetric(m_rr, sides);  // m_rr^-1 (f_modes, momenta at rest of each other column)

  tape_.section("mass matrix with modes that follow");
  Matrix<Expr> M(size(others), size(others));
  std::vector<Expr> f = picked(d.f_r, others);
  for (int j = 0; j < size(others); ++j) {
    const std::vector<Expr>& yielding = follow[static_cast<std::size_t>(j) + 1];
    std::vector<Expr> h = column_of(H, others[static_cast<std::size_t>(j)]);
    for (std::size_t i = 0; i < rows.size(); ++i) h[static_cast<std::size_t>(rows[i])] -= yielding[i];
    const std::vector<Expr> column = picked(H.transposed() * mass_times(of.partition, state, h), others);
    for (int i = j; i < size(others); ++i) M(i, j) = M(j, i) = column[static_cast<std::size_t>(i)];
    for (std::size_t i = 0; i < modes.size(); ++i)
      f[static_cast<std::size_t>(j)] -= yielding[i] * sides[0][i];
  }
  const std::vector<Expr> of_others = solve_symmetric(M, {f}).front();
  std::vector<Expr> of_modes = follow[0];
  for (std::size_t j = 0; j < others.size(); ++j) {
    for (std::size_t i = 0; i < modes.size(); ++i) of_modes[i] -= follow[j + 1][i] * of_others[j];
  }
  std::vector<Expr> nu_dot(static_cast<std::size_t>(H.cols()), Expr(0));
  for (std::size_t j = 0; j < others.size(); ++j) nu_dot[static_cast<std::size_t>(others[j])] = of_others[j];
  for (std::size_t i = 0; i < modes.size(); ++i) nu_dot[static_cast<std::size_t>(modes[i])] = of_modes[i];
  tape_.section("accelerations");
  std::vector<Expr> v_dot = accelerations(of, H, d, nu_dot);
  return {std::move(nu_dot), std::move(v_dot)};
}

bool Deriver::have_inertia(const Matrix<Expr>& M, const SymmetricFactors& factors) {
  constexpr double rounded_zero = 1e-9;  // pivots that should be zero come out as 1e-16 or so of the diagonal
  std::vector<NodeId> nodes;
  for (int i = 0; i < M.rows(); ++i)
    nodes.push_back((factors.pivots()[static_cast<std::size_t>(i)] / M(i, i)).id(tape_));
  ReproducibleInterpreter values(tape_, nodes);
  for (const std::vector<double>& state : states_of(atlas_, chart_, measured_states)) {
    for (const double pivot : values(state)) {
      if (!(pivot > rounded_zero)) return false;
    }
  }
  return true;
}

std::optional<std::pair<std::vector<Expr>, std::vector<Expr>>> Deriver::solved_with_multipliers(
    const Reduced& of, const std::vector<Expr>& nu, const std::vector<Expr>& r_a_dot,
    const std::vector<Expr>& r_a_ddot, const std::vector<Expr>& input_force) {
  const KinematicReduction& k = *of.reduction;
  const Partition& p = of.partition;
  const int rows = k.rows().A.rows();
  if (rows == 0 || rows != of.ranks.m_locked || k.kernel().content_divided) return std::nullopt;
  const auto reversed = [](std::vector<Expr> v) {
    std::ranges::reverse(v);
    return v;
  };
  tape_.section("admissible velocities");
  const std::vector<Expr> velocity = merged(p, k.velocities(r_a_dot, nu), r_a_dot);
  const State<Expr> state = symbols_.moving(velocity);
  const std::vector<Expr> bias = dynamics_.constraints(state).second;
  const Matrix<Expr> M = dynamics_.mass_matrix(state);
  std::vector<Expr> force = input_force;
  const std::vector<Expr> free = picked(dynamics_.forces(state), p.passive);
  const std::vector<Expr> carried = M.block(p.passive, p.active) * r_a_ddot;
  for (std::size_t i = 0; i < force.size(); ++i) force[i] += free[i] - carried[i];

  tape_.section("factors of the mass matrix");
  std::vector<int> leaves_first = p.passive;  // a tree's branches then meet in their trunk only
  std::ranges::reverse(leaves_first);
  const Matrix<Expr> M_p = M.block(leaves_first, leaves_first);
  const SymmetricFactors factors(M_p);
  if (!have_inertia(M_p, factors)) return std::nullopt;
  const std::vector<Expr> along_force = factors.forward(reversed(force));
  const std::vector<Expr> without_rows = factors.scaled(along_force);
  std::vector<std::vector<Expr>> along_rows, scaled_rows;
  for (int i = 0; i < rows; ++i) {
    std::vector<Expr> row;
    for (int j = 0; j < k.rows().A.cols(); ++j) row.push_back(k.rows().A(i, j));
    along_rows.push_back(factors.forward(reversed(std::move(row))));
    scaled_rows.push_back(factors.scaled(along_rows.back()));
  }

  tape_.section("multipliers");
  const auto inner = [](const std::vector<Expr>& a, const std::vector<Expr>& b) {
    Expr sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  };
  Matrix<Expr> S(rows, rows);  // A M^-1 A^T
  std::vector<Expr> missing;   // accelerations of the rows
  const std::vector<Expr> driven = k.rows().B * r_a_ddot;
  for (std::size_t i = 0; i < along_rows.size(); ++i) {
    for (std::size_t j = i; j < along_rows.size(); ++j) {
      const Expr product = inner(along_rows[i], scaled_rows[j]);
      S(static_cast<int>(i), static_cast<int>(j)) = S(static_cast<int>(j), static_cast<int>(i)) = product;
    }
    missing.push_back(-(inner(along_rows[i], without_rows) + bias[i] + driven[i]));
  }
  const std::vector<Expr> lambda = solve_symmetric(S, {missing}).front();

  tape_.section("accelerations");
  std::vector<Expr> v_dot = without_rows;
  for (std::size_t j = 0; j < v_dot.size(); ++j) {
    for (std::size_t i = 0; i < lambda.size(); ++i) v_dot[j] += scaled_rows[i][j] * lambda[i];
  }
  v_dot = reversed(factors.backward(std::move(v_dot)));
  return std::pair{picked(v_dot, k.kernel().free), merged(p, v_dot, r_a_ddot)};
}

std::vector<Route> Deriver::accurate_routes(const Reduced& of, const std::string& name,
                                            const std::vector<Expr>& nu, const std::vector<Expr>& r_a_dot,
                                            const std::vector<Expr>& r_a_ddot,
                                            const std::vector<Expr>& input_force) {
  std::vector<Route> routes;
  const auto add = [&](const std::string& route, const auto& solution) {
    routes.push_back({route, acceleration_blocks(of, name, solution)});
  };
  if (of.k() > 1) {  // one column is orthogonal
    for (const bool project : {true, false}) {
      add(std::string("orthogonal basis, ") + (project ? "projected recursion" : "all blocks"),
          solved_on_orthogonal_basis(of, nu, r_a_dot, r_a_ddot, input_force, project));
    }
  }
  if (const std::size_t modes = modal_columns(of).size(); modes > 0 && static_cast<int>(modes) < of.k())
    add("modes first", solved_modes_first(of, nu, r_a_dot, r_a_ddot, input_force));
  try {
    if (const auto solution = solved_with_multipliers(of, nu, r_a_dot, r_a_ddot, input_force))
      add("multipliers", *solution);
  } catch (const std::domain_error&) {  // a pivot is zero for all parameters: a velocity without inertia
  }
  return routes;
}

}  // namespace anholon
