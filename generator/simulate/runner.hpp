// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The functions of a scene, bound to one set of buffers, and the field of its reduced dynamics.

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anholon/charts.hpp"
#include "simulate/bound_call.hpp"
#include "simulate/buffers.hpp"
#include "simulate/scene_program.hpp"
#include "simulate/table_motion.hpp"

namespace anholon {

/// The functions that know nu.
struct ChartCalls {
  Call imposed_torque, rates, kinematics, torques, multipliers, reduced_velocities, compatibility,
      projected_accelerations, field_jacobian;
};

/// y = (r_p, r_d, nu), then work and dissipated energy where y has room for them; behind r_d the
/// motion-driven coordinates where their motion is projected.
template <class S>
class Runner : public ChartCalls {
 public:
  template <class Code>
  Runner(const Scene& scene, const SceneProgram& program, const Code& code)
      : program_(program), k_(program.derivation->reduction.kernel.H.cols()) {
    const std::size_t active = program.reduced.active.size();
    b.t.resize(1), b.g.resize(3), b.R.resize(9), b.p.resize(positions(program.model.group));
    b.r_p.resize(static_cast<std::size_t>(program.original.s_p())),
        b.r_a.resize(program.original.active.size());
    for (auto* v : {&b.r_a_dot, &b.r_a_ddot, &b.r_m, &b.r_m_dot, &b.r_m_ddot, &b.r_a_dddot, &b.r_m_dddot})
      v->resize(active);
    b.nu.resize(static_cast<std::size_t>(k_)), b.nu_dot.resize(static_cast<std::size_t>(k_));
    b.eta.resize(static_cast<std::size_t>(program.original.n)), b.r_p_dot.resize(b.r_p.size());
    b.r_d_dot.resize(program.driven.size()), b.torque.resize(program.driven.size()),
        b.tau_d.resize(program.driven.size());
    b.dissipated_power.resize(1), b.applied_power.resize(1), b.kinetic.resize(1), b.gravity.resize(1),
        b.elastic.resize(1);
    for (std::size_t i = 0; i < program.original.active.size(); ++i) {
      const bool driven =
          std::ranges::find(program.driven, program.original.active[i]) != program.driven.end();
      (driven ? driven_at_ : motion_at_).push_back(i);
    }
    carried_at_ = driven_at_;
    if (program.projects_motion) carried_at_.insert(carried_at_.end(), motion_at_.begin(), motion_at_.end());
    imposed = bound(code, "imposed", b), constraints = bound(code, "constraints", b),
    energies = bound(code, "energies", b), position_conditions = bound(code, "position_conditions", b);
    chart_quality = bound(code, "chart_quality", b), projected_rates = bound(code, "projected_rates", b);
    for (std::size_t c = 0; c < program.derivation->reduction.charts.size(); ++c) {
      const std::string chart = chart_prefix(c);
      charts_.push_back({bound(code, chart + "imposed_torque", b), bound(code, chart + "rates", b),
                         bound(code, chart + "kinematics", b), bound(code, chart + "inverse_torques", b),
                         bound(code, chart + "multipliers", b), bound(code, chart + "reduced_velocities", b),
                         bound(code, chart + "compatibility", b),
                         bound(code, chart + "projected_accelerations", b),
                         bound(code, chart + "field_jacobian", b)});
    }
    use_chart(0);
    contact_shares = bound(code, "contact_shares", b);
    if (scene.motion_table) table_.emplace(scene, program);
  }

  /// Imposed motion at t.
  void impose(S t) {
    b.t[0] = t;
    if (imposed) imposed();
    if (table_) (*table_)(t, b);
    if (projected_rates) return;  // follows from the position: set()
    for (std::size_t i = 0; i < motion_at_.size(); ++i)
      b.r_a[motion_at_[i]] = b.r_m[i], b.r_a_dot[i] = b.r_m_dot[i], b.r_a_ddot[i] = b.r_m_ddot[i],
      b.r_a_dddot[i] = b.r_m_dddot[i];
  }

  /// Pose, shape and reduced velocities, and the torques that follow from them. Needs impose().
  template <class G, class Vector>
  void set(const G& g, const Vector& y) {
    const auto R = g.R();
    const auto p = g.p();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) b.R[static_cast<std::size_t>(3 * i + j)] = R(i, j);
    }
    for (std::size_t i = 0; i < b.p.size(); ++i) b.p[i] = p(static_cast<Eigen::Index>(i));
    if constexpr (requires { g.theta(); }) b.g[0] = g.x(), b.g[1] = g.y(), b.g[2] = g.theta();
    Eigen::Index next = 0;
    for (S& x : b.r_p) x = y(next++);
    for (const std::size_t i : carried_at_) b.r_a[i] = y(next++);
    for (S& x : b.nu) x = y(next++);
    if (projected_rates) projected_rates(), projected_accelerations();
    if (!imposed_torque) return;
    imposed_torque();
    std::vector<S>& tau = motion_at_.empty() ? b.tau_a : b.tau_d;
    for (std::size_t i = 0; i < driven_at_.size(); ++i) tau[i] = b.torque[i];
  }

  /// How many bases there are for the admissible velocities, and which one nu means now.
  [[nodiscard]] std::size_t charts() const { return charts_.size(); }
  [[nodiscard]] std::size_t chart() const { return static_cast<std::size_t>(chart_number) - 1; }
  void use_chart(std::size_t chart) {
    chart_number = static_cast<double>(chart + 1);
    static_cast<ChartCalls&>(*this) = charts_[chart];
  }
  /// The chart that is best at the position in the buffers.
  [[nodiscard]] std::size_t best_chart_here() {
    if (!chart_quality) return 0;
    chart_quality();
    return best_chart(std::span<const S>(b.chart_quality));
  }
  /// Goes on in another chart where the present one has become poor; the velocities stay, nu in y changes.
  /// @return whether it did. Needs impose().
  template <class G, class Vector>
  bool change_chart(const G& g, Vector& y) {
    if (!chart_quality) return false;
    set(g, y);
    chart_quality();
    const std::size_t next = next_chart(std::span<const S>(b.chart_quality), chart());
    if (next == chart()) return false;
    move_to_chart(next, y);
    return true;
  }
  /// Expresses the velocities in a chart. Needs set().
  template <class Vector>
  void move_to_chart(std::size_t next, Vector& y) {
    if (next == chart()) return;
    kinematics();
    use_chart(next);
    reduced_velocities();
    const auto shape = static_cast<Eigen::Index>(b.r_p.size() + carried_at_.size());
    for (std::size_t i = 0; i < b.nu.size(); ++i) y(shape + static_cast<Eigen::Index>(i)) = b.nu[i];
  }

  /// Coordinates of r_a that are part of the state, in the order of y: torque-driven ones, and those whose
  /// motion is projected.
  [[nodiscard]] std::vector<S> carried_coordinates() const {
    std::vector<S> r;
    for (const std::size_t i : carried_at_) r.push_back(b.r_a[i]);
    return r;
  }
  /// Starts a projected motion where the wanted one is. Needs impose().
  template <class Vector>
  void start_at_wanted_motion(Vector& y) const {
    if (!projected_rates) return;
    const auto at = static_cast<Eigen::Index>(b.r_p.size() + driven_at_.size());
    for (std::size_t i = 0; i < motion_at_.size(); ++i) y(at + static_cast<Eigen::Index>(i)) = b.r_m[i];
  }
  /// Largest distance of the motion-driven coordinates from what the scene wants, rad or m.
  [[nodiscard]] S departure() const {
    S largest = S(0);
    for (std::size_t i = 0; i < motion_at_.size(); ++i)
      largest = std::max(largest, std::abs(b.r_a[motion_at_[i]] - b.r_m[i]));
    return largest;
  }

  /// Size of y without quadratures.
  [[nodiscard]] int size() const { return static_cast<int>(b.r_p.size() + carried_at_.size()) + k_; }

  template <class G, class Vector, class Tangent>
  void field(S t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot) {
    ++evaluations;
    impose(t);
    set(g, y);
    if (rates) rates();
    eta.setZero();  // translations are those of space, of which a group may leave fewer
    for (std::size_t i = 0; i < b.eta.size(); ++i) eta(static_cast<Eigen::Index>(i)) = b.eta[i];
    Eigen::Index next = 0;
    for (const S& x : b.r_p_dot) y_dot(next++) = x;
    for (const S& x : b.r_d_dot) y_dot(next++) = x;
    if (projected_rates) {
      for (const S& x : b.r_a_dot) y_dot(next++) = x;
    }
    for (const S& x : b.nu_dot) y_dot(next++) = x;
    if (stopped_) {
      eta.setConstant(std::numeric_limits<S>::quiet_NaN());
      y_dot.setConstant(std::numeric_limits<S>::quiet_NaN());
    }
    if (y.size() == next) return;
    if (energies) energies();
    y_dot(next++) = power() + b.applied_power[0];
    y_dot(next) = b.dissipated_power[0];
  }

  /// The derivative of the field by (twist of g in body axes, y) and by t. Needs a program that has it.
  template <class G, class Vector, class Matrix>
  void jacobian(S t, const G& g, const Vector& y, Matrix& F, Vector& F_t) {
    impose(t);
    set(g, y);
    if (rates) rates();
    field_jacobian();
    F.setZero();
    F_t.setZero();
    const auto n = static_cast<Eigen::Index>(b.eta.size()), columns = n + size();
    const auto at = [n](Eigen::Index i) { return i < n ? i : i - n + G::dim; };
    const auto place = [&](const std::vector<S>& by_state, const std::vector<S>& by_time, Eigen::Index first,
                           Eigen::Index rows) {
      for (Eigen::Index i = 0; i < rows; ++i) {
        for (Eigen::Index j = 0; j < columns; ++j)
          F(at(first + i), at(j)) = by_state[static_cast<std::size_t>(i * columns + j)];
        F_t(at(first + i)) = by_time[static_cast<std::size_t>(i)];
      }
    };
    place(b.rates_x, b.rates_t, 0, columns);
    if (y.size() > size()) place(b.power_x, b.power_t, columns, 2);
    if (stopped_) F.setConstant(std::numeric_limits<S>::quiet_NaN());
  }

  /// The field as a function object, for integration in groups of the same scalar.
  template <class G>
  auto field_of() {
    return
        [this](S t, const G& g, const auto& y, auto& eta, auto& y_dot) { this->field(t, g, y, eta, y_dot); };
  }

  /// From now on the field is not finite, so that an integrator ends.
  void stop() { stopped_ = true; }

  /// The field with its changes of chart at the ends of steps.
  template <class G>
  struct ChartedField {
    Runner& run;
    template <class Vector, class Tangent>
    void operator()(S t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot) const {
      run.field(t, g, y, eta, y_dot);
    }
    template <class Vector, class Matrix>
    void jacobian(S t, const G& g, const Vector& y, Matrix& F, Vector& F_t) const {
      run.jacobian(t, g, y, F, F_t);
    }
    template <class Vector>
    bool correct(S t, G& g, Vector& y) const {
      if (run.charts() < 2) return false;
      run.impose(t);
      return run.change_chart(g, y);
    }
  };
  template <class G>
  ChartedField<G> charted_field() {
    return {*this};
  }
  /// Writes the velocities of a state in the chart that is best there, so that final states can be compared.
  template <class State>
  void express_in_best_chart(State& state) {
    if (charts() < 2) return;
    impose(state.t);
    set(state.g, state.y);
    move_to_chart(best_chart_here(), state.y);
  }

  /// Power of imposed and computed torques, after rates().
  S power() {
    S sum = S(0);
    if (torques) {
      torques();
      for (std::size_t i = 0; i < b.r_a_dot.size(); ++i) sum += b.tau_a[i] * b.r_a_dot[i];
    }
    for (std::size_t i = 0; i < b.r_d_dot.size(); ++i) sum += b.torque[i] * b.r_d_dot[i];
    return sum;
  }

  Buffers<S> b;
  Call imposed, constraints, energies, position_conditions, chart_quality, projected_rates, contact_shares;
  long evaluations = 0;
  double chart_number = 1;  // of the chart in use, for reports

 private:
  /// Components of the position that a program takes: those that the group leaves free, none of a planar
  /// pose.
  static std::size_t positions(GroupKind group) {
    const auto components = free_components(group);
    return group == GroupKind::SE2
               ? 0
               : static_cast<std::size_t>(std::ranges::count_if(components, [](int c) { return c < 3; }));
  }

  const SceneProgram& program_;
  int k_;
  std::vector<std::size_t> motion_at_, driven_at_, carried_at_;  // positions in r_a
  bool stopped_ = false;
  std::vector<ChartCalls> charts_;
  std::optional<TableMotion<S>> table_;
};

}  // namespace anholon
