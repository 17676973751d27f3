// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <functional>
#include <map>
#include <memory>

#include "anholon/free_dynamics.hpp"
#include "anholon/integrate/dopri.hpp"
#include "anholon/integrate/rkmk.hpp"
#include "anholon/lie/se2.hpp"
#include "anholon/lie/se3.hpp"
#include "anholon/lie/so3.hpp"
#include "anholon/lie/translation.hpp"
#include "anholon/lie/trivial.hpp"
#include "anholon/monitors.hpp"
#include "anholon/motion.hpp"
#include "anholon/reduction.hpp"
#include "check/compile_cache.hpp"
#include "derive/derive.hpp"
#include "describe/mechanise.hpp"
#include "describe/specialise.hpp"
#include "optimise/tape/count.hpp"
#include "tape/interpret.hpp"

namespace anholon {
namespace {

double cpu_now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// The program of a scene with two more functions: `imposed(t)`, and `rates`, all that a step of integration
/// needs.
struct SceneProgram {
  Model model;  // specialised
  std::unique_ptr<Derivation> derivation;
  Partition original, reduced;  // all active apart; torque-driven ones with the passive
  std::vector<int> driven;      // torque-driven velocity indices
  int operations = 0;
};

/// Expressions of the scene on the program's tape. Velocities are those that nu and r_a_dot mean.
std::vector<NodeId> copied(const Scene& scene, const SceneProgram& p, const std::vector<Expr>& expressions) {
  Program& program = p.derivation->program;
  Tape& from = *scene.model.tape;
  std::vector<Expr> inputs(from.inputs().size(), Expr(0));
  const StateSymbols& s = scene.model.symbols;
  const auto set = [&](NodeId symbol, NodeId value) {
    inputs[from.node(symbol).a] = Expr(program.tape, value);
  };
  const auto block = [&](const std::string& name) {
    const auto found = std::ranges::find(program.inputs, name, &InputBlock::name);
    return found == program.inputs.end() ? std::vector<NodeId>{} : found->nodes;
  };
  const auto velocity = [&](const std::string& name) {  // an output of the kinematics, or imposed
    for (const Function& f : program.functions) {
      for (const OutputBlock& b : f.outputs) {
        if (f.name == "kinematics" && b.name == name) return b.nodes;
      }
    }
    return block(name);
  };
  for (std::size_t i = 0; i < scene.model.parameters.size(); ++i) {
    const Parameter& parameter = scene.model.parameters[i];
    const auto kept = std::ranges::find(program.parameters, parameter.name, &ParameterInfo::name);
    set(s.parameters[i],
        kept != program.parameters.end() ? kept->node : program.tape.constant(parameter.value));
  }
  set(s.t, block("t")[0]);
  const GroupKind group = p.model.group;
  if (group == GroupKind::SE2) {
    const std::vector<NodeId> g = block("g");
    const Mat3<Expr> R =
        AxisRotation<Expr>{2, cos(Expr(program.tape, g[2])), sin(Expr(program.tape, g[2]))}.matrix();
    for (std::size_t i = 0; i < 9; ++i) set(s.R[i], R.m[i].id(program.tape));
    set(s.p[0], g[0]), set(s.p[1], g[1]);
  } else {
    for (const std::size_t i : {0U, 4U, 8U}) set(s.R[i], program.tape.constant(1));
    const std::vector<NodeId> R = block("R"), position = block("p");
    for (std::size_t i = 0; i < R.size(); ++i) set(s.R[i], R[i]);
    for (std::size_t i = 0; i < position.size(); ++i) set(s.p[i], position[i]);
  }
  const auto components = free_components(group);
  const std::vector<NodeId> eta = velocity("eta"), r_p = block("r_p"), r_a = block("r_a");
  for (std::size_t i = 0; i < eta.size(); ++i) set(s.eta[static_cast<std::size_t>(components[i])], eta[i]);
  const std::vector<int> kept = kept_coordinates(scene.model, scene);
  const auto each = [&](const std::vector<NodeId>& nodes, const std::vector<int>& velocities,
                        const std::vector<NodeId>& symbols) {
    for (std::size_t c = 0; c < kept.size(); ++c) {
      const auto at = std::ranges::find(velocities, kept[c] + p.original.n);
      if (kept[c] >= 0 && at != velocities.end() && !nodes.empty())
        set(symbols[c], nodes[static_cast<std::size_t>(at - velocities.begin())]);
    }
  };
  const std::vector<int> passive(p.original.passive.begin() + p.original.n, p.original.passive.end());
  each(r_p, passive, s.r), each(r_a, p.original.active, s.r);
  each(velocity("r_p_dot"), passive, s.r_dot), each(velocity("r_d_dot"), p.driven, s.r_dot),
      each(block("r_a_dot"), p.reduced.active, s.r_dot);
  for (const LockedCoordinate& locked : scene.locked) {
    const NodeId value = locked.value.id(from);
    inputs[from.node(s.r[static_cast<std::size_t>(locked.coordinate)]).a] =
        interpret<Expr>(from, {value}, inputs, FromExact<Expr>{&program.tape}).front();
  }
  std::vector<NodeId> roots;
  for (const Expr& e : expressions) roots.push_back(e.id(from));
  std::vector<NodeId> result;
  for (const Expr& e : interpret<Expr>(from, roots, inputs, FromExact<Expr>{&program.tape}))
    result.push_back(e.id(program.tape));
  return result;
}

SceneProgram make_program(const Scene& scene) {
  SceneProgram p{specialise(scene.model, scene), nullptr, {}, {}, {}};
  DeriveRequest request;
  request.scene = scene.name;
  request.torque_driven = {scene.torque_driven.begin(), scene.torque_driven.end()};
  request.functions = {"kinematics",      "reduced_velocities", "constraints",   "forward_dynamics",
                       "inverse_torques", "multipliers",        "compatibility", "energies"};
  p.derivation = derive(p.model, request);
  p.original = partition_of(p.model);
  p.reduced = partition_of(p.model, request.torque_driven);
  for (const int i : p.original.active) {
    if (std::ranges::find(p.reduced.active, i) == p.reduced.active.end()) p.driven.push_back(i);
  }
  Program& program = p.derivation->program;

  // r_a(t) and its derivatives, in the order of the reduced partition's active coordinates
  const std::vector<int> kept = kept_coordinates(scene.model, scene);
  Function imposed{"imposed", "Imposed motion of the active coordinates.", {}, ""};
  if (!scene.motion_table) {
    std::vector<Expr> r, r_dot, r_ddot;
    for (const int i : p.reduced.active) {
      const auto motion = std::ranges::find_if(scene.motion, [&](const ImposedMotion& m) {
        return kept[static_cast<std::size_t>(m.coordinate)] == i - p.original.n;
      });
      r.push_back(motion == scene.motion.end() ? Expr(0) : motion->r);
      r_dot.push_back(motion == scene.motion.end() ? Expr(0) : motion->r_dot);
      r_ddot.push_back(motion == scene.motion.end() ? Expr(0) : motion->r_ddot);
    }
    const int size = static_cast<int>(r.size());
    if (size > 0) {
      imposed.outputs = {
          {"r_m", "rad or m", "motion-driven coordinates", size, 1, copied(scene, p, r)},
          {"r_m_dot", "rad/s or m/s", "their rates", size, 1, copied(scene, p, r_dot)},
          {"r_m_ddot", "rad/s^2 or m/s^2", "their second derivatives", size, 1, copied(scene, p, r_ddot)}};
    }
  }
  if (!scene.torques.empty() || !p.driven.empty()) {
    std::vector<Expr> torque;
    for (const int i : p.driven) {
      const auto found = std::ranges::find_if(scene.torques, [&](const ImposedTorque& x) {
        return kept[static_cast<std::size_t>(x.coordinate)] == i - p.original.n;
      });
      torque.push_back(found == scene.torques.end() ? Expr(0) : found->torque);
    }
    if (!torque.empty()) {
      program.functions.push_back({"imposed_torque",
                                   "Torques on the torque-driven coordinates.",
                                   {{"torque", "N m or N", "torque-driven coordinates",
                                     static_cast<int>(torque.size()), 1, copied(scene, p, torque)}},
                                   ""});
    }
  }
  if (!imposed.outputs.empty()) program.functions.push_back(imposed);

  Function rates{"rates", "Velocities and reduced accelerations for one evaluation of the field.", {}, ""};
  std::vector<NodeId> roots;
  for (const Function& f : program.functions) {
    for (const OutputBlock& b : f.outputs) {
      const bool velocity =
          f.name == "kinematics" && (b.name == "eta" || b.name == "r_p_dot" || b.name == "r_d_dot");
      if (!velocity && !(f.name == "forward_dynamics" && b.name == "nu_dot")) continue;
      rates.outputs.push_back(b);
      roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
    }
  }
  p.operations = operations_per_call(program, roots).total();
  if (!rates.outputs.empty()) program.functions.push_back(rates);
  return p;
}

/// Every array that the functions of a scene read or write, by the name of its block.
template <class S>
struct Buffers {
  std::vector<S> t, g, R, p, r_p, r_a, r_a_dot, r_a_ddot, r_d_dot, nu, nu_dot, eta, r_p_dot, r_m, r_m_dot,
      r_m_ddot, tau_a, tau_d, torque, lambda, kinetic, gravity, elastic, dissipated_power, applied_power, A,
      B_p, B_a, velocity_residual;
  std::map<std::string, std::vector<S>> others;

  std::vector<S>& operator[](const std::string& name) {
    using Member = std::vector<S> Buffers::*;
    static const std::map<std::string, Member> members = {{"t", &Buffers::t},
                                                          {"g", &Buffers::g},
                                                          {"R", &Buffers::R},
                                                          {"p", &Buffers::p},
                                                          {"r_p", &Buffers::r_p},
                                                          {"r_a", &Buffers::r_a},
                                                          {"r_a_dot", &Buffers::r_a_dot},
                                                          {"r_a_ddot", &Buffers::r_a_ddot},
                                                          {"r_d_dot", &Buffers::r_d_dot},
                                                          {"nu", &Buffers::nu},
                                                          {"nu_dot", &Buffers::nu_dot},
                                                          {"eta", &Buffers::eta},
                                                          {"r_p_dot", &Buffers::r_p_dot},
                                                          {"r_m", &Buffers::r_m},
                                                          {"r_m_dot", &Buffers::r_m_dot},
                                                          {"r_m_ddot", &Buffers::r_m_ddot},
                                                          {"tau_a", &Buffers::tau_a},
                                                          {"tau_d", &Buffers::tau_d},
                                                          {"torque", &Buffers::torque},
                                                          {"lambda", &Buffers::lambda},
                                                          {"kinetic", &Buffers::kinetic},
                                                          {"gravity", &Buffers::gravity},
                                                          {"elastic", &Buffers::elastic},
                                                          {"dissipated_power", &Buffers::dissipated_power},
                                                          {"applied_power", &Buffers::applied_power},
                                                          {"A", &Buffers::A},
                                                          {"B_p", &Buffers::B_p},
                                                          {"B_a", &Buffers::B_a},
                                                          {"velocity_residual", &Buffers::velocity_residual}};
    const auto member = members.find(name);
    return member != members.end() ? this->*(member->second) : others[name];
  }
};

/// A function bound to buffers: calling it allocates nothing.
using Call = std::function<void()>;

Call bound(const std::shared_ptr<CompiledProgram>& code, const std::string& name, Buffers<double>& buffers) {
  if (!code->has(name)) return {};
  const anholon_function& function = code->function(name);
  const auto pointer = [&](const anholon_block& b) {
    std::vector<double>& values = buffers[b.name];
    values.resize(static_cast<std::size_t>(b.rows) * static_cast<std::size_t>(b.cols), 0.0);
    return values.data();
  };
  std::vector<const double*> inputs;
  std::vector<double*> outputs;
  for (int i = 0; i < function.input_count; ++i) inputs.push_back(pointer(function.inputs[i]));
  for (int i = 0; i < function.output_count; ++i) outputs.push_back(pointer(function.outputs[i]));
  return [code, &function, inputs, outputs] { code->call(function, inputs.data(), outputs.data()); };
}

/// The same by interpretation of the tape, for the long double reference.
Call bound(const Program* program, const std::string& name, Buffers<long double>& buffers) {
  const auto function = std::ranges::find(program->functions, name, &Function::name);
  if (function == program->functions.end()) return {};
  struct Work {
    Interpreter<long double> interpreter;
    std::vector<long double> values, flat;
    std::vector<std::pair<std::vector<long double>*, const InputBlock*>> inputs;
    std::vector<std::pair<std::vector<long double>*, std::size_t>> outputs;
  };
  auto work = std::make_shared<Work>();
  std::vector<NodeId> roots;
  for (const OutputBlock& b : function->outputs) {
    buffers[b.name].resize(b.nodes.size(), 0);
    work->outputs.emplace_back(&buffers[b.name], b.nodes.size());
    roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  }
  for (const InputBlock& b : program->inputs) {
    buffers[b.name].resize(b.nodes.size(), 0);
    work->inputs.emplace_back(&buffers[b.name], &b);
  }
  work->interpreter = Interpreter<long double>(program->tape, roots);
  work->values.assign(program->tape.inputs().size(), 0);
  for (const ParameterInfo& p : program->parameters)
    work->values[program->tape.node(p.node).a] = FromExact<long double>{}(p.value);
  work->flat.resize(roots.size());
  return [work, program] {
    for (const auto& [from, block] : work->inputs) {
      for (std::size_t i = 0; i < block->nodes.size(); ++i)
        work->values[program->tape.node(block->nodes[i]).a] = (*from)[i];
    }
    work->interpreter(work->values, work->flat);
    std::size_t next = 0;
    for (const auto& [to, size] : work->outputs) {
      for (std::size_t i = 0; i < size; ++i) (*to)[i] = work->flat[next++];
    }
  };
}

/// r_a(t) from a table.
template <class S>
class TableMotion {
 public:
  TableMotion(const Scene& scene, const SceneProgram& program) {
    const MotionTable& table = *scene.motion_table;
    const auto rows = static_cast<Eigen::Index>(table.times.size());
    Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic> values(
        rows, static_cast<Eigen::Index>(program.reduced.active.size()));
    std::vector<S> times;
    values.setZero();
    const std::vector<int> kept = kept_coordinates(scene.model, scene);
    for (const double t : table.times) times.push_back(S(t));
    for (std::size_t c = 0; c < table.coordinates.size(); ++c) {
      const int index = kept[static_cast<std::size_t>(table.coordinates[c])] + program.original.n;
      const auto column = std::ranges::find(program.reduced.active, index) - program.reduced.active.begin();
      for (Eigen::Index i = 0; i < rows; ++i)
        values(i, column) = S(table.rows[static_cast<std::size_t>(i)][c]);
    }
    using Ends = MotionTable::Ends;
    spline_.emplace(times, values,
                    table.ends == Ends::periodic  ? SplineEnds::periodic
                    : table.ends == Ends::clamped ? SplineEnds::clamped
                                                  : SplineEnds::natural);
    r_.setZero(values.cols()), r_dot_.setZero(values.cols()), r_ddot_.setZero(values.cols());
  }
  void operator()(S t, Buffers<S>& b) {
    spline_->evaluate(t, r_, r_dot_, r_ddot_);
    for (Eigen::Index i = 0; i < r_.size(); ++i) {
      const auto at = static_cast<std::size_t>(i);
      b.r_m[at] = r_(i), b.r_m_dot[at] = r_dot_(i), b.r_m_ddot[at] = r_ddot_(i);
    }
  }

 private:
  std::optional<TabulatedMotion<S>> spline_;
  Eigen::Matrix<S, Eigen::Dynamic, 1> r_, r_dot_, r_ddot_;
};

/// The functions of a scene and their buffers. y = (r_p, r_d, nu, then work and dissipated energy where they
/// are kept).
template <class S>
class Runner {
 public:
  template <class Code>
  Runner(const Scene& scene, const SceneProgram& program, const Code& code)
      : program_(program), k_(program.derivation->reduction.kernel.H.cols()) {
    const std::size_t active = program.reduced.active.size();
    b.t.resize(1), b.g.resize(3), b.R.resize(9), b.p.resize(3);
    b.r_p.resize(static_cast<std::size_t>(program.original.s_p())),
        b.r_a.resize(program.original.active.size());
    for (auto* v : {&b.r_a_dot, &b.r_a_ddot, &b.r_m, &b.r_m_dot, &b.r_m_ddot}) v->resize(active);
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
    imposed = bound(code, "imposed", b), imposed_torque = bound(code, "imposed_torque", b),
    rates = bound(code, "rates", b), kinematics = bound(code, "kinematics", b),
    torques = bound(code, "inverse_torques", b);
    multipliers = bound(code, "multipliers", b), constraints = bound(code, "constraints", b),
    energies = bound(code, "energies", b);
    reduced_velocities = bound(code, "reduced_velocities", b),
    compatibility = bound(code, "compatibility", b);
    if (scene.motion_table) table_.emplace(scene, program);
  }

  /// Imposed motion at t.
  void impose(S t) {
    b.t[0] = t;
    if (imposed) imposed();
    if (table_) (*table_)(t, b);
    for (std::size_t i = 0; i < motion_at_.size(); ++i)
      b.r_a[motion_at_[i]] = b.r_m[i], b.r_a_dot[i] = b.r_m_dot[i], b.r_a_ddot[i] = b.r_m_ddot[i];
  }

  /// Pose, shape and reduced velocities, and the torques that follow from them. Needs impose().
  template <class G, class Vector>
  void set(const G& g, const Vector& y) {
    const auto R = g.R();
    const auto p = g.p();
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) b.R[static_cast<std::size_t>(3 * i + j)] = R(i, j);
      b.p[static_cast<std::size_t>(i)] = p(i);
    }
    if constexpr (requires { g.theta(); }) b.g[0] = g.x(), b.g[1] = g.y(), b.g[2] = g.theta();
    Eigen::Index next = 0;
    for (S& x : b.r_p) x = y(next++);
    for (const std::size_t i : driven_at_) b.r_a[i] = y(next++);
    for (S& x : b.nu) x = y(next++);
    if (!imposed_torque) return;
    imposed_torque();
    std::vector<S>& tau = motion_at_.empty() ? b.tau_a : b.tau_d;
    for (std::size_t i = 0; i < driven_at_.size(); ++i) tau[i] = b.torque[i];
  }

  /// Size of y without quadratures.
  [[nodiscard]] int size() const { return static_cast<int>(b.r_p.size() + driven_at_.size()) + k_; }

  template <class G, class Vector, class Tangent>
  void field(S t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot) {
    ++evaluations;
    impose(t);
    set(g, y);
    if (rates) rates();
    for (Eigen::Index i = 0; i < eta.size(); ++i) eta(i) = b.eta[static_cast<std::size_t>(i)];
    Eigen::Index next = 0;
    for (const S& x : b.r_p_dot) y_dot(next++) = x;
    for (const S& x : b.r_d_dot) y_dot(next++) = x;
    for (const S& x : b.nu_dot) y_dot(next++) = x;
    if (y.size() == next) return;
    if (energies) energies();
    y_dot(next++) = power() + b.applied_power[0];
    y_dot(next) = b.dissipated_power[0];
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
  Call imposed, imposed_torque, rates, kinematics, torques, multipliers, constraints, energies,
      reduced_velocities, compatibility;
  long evaluations = 0;

 private:
  const SceneProgram& program_;
  int k_;
  std::vector<std::size_t> motion_at_, driven_at_;  // positions in r_a
  std::optional<TableMotion<S>> table_;
};

template <class G>
G pose_of(const InitialState& initial) {
  using Real = typename G::Scalar;
  Eigen::Matrix<Real, 3, 3> R;
  Eigen::Matrix<Real, 3, 1> p;
  const FromExact<Real> real;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R(i, j) = real(initial.R[static_cast<std::size_t>(3 * i + j)]);
    p(i) = real(initial.p[static_cast<std::size_t>(i)]);
  }
  const Eigen::Quaternion<Real> q(R);
  const Eigen::Matrix<Real, 4, 1> wxyz(q.w(), q.x(), q.y(), q.z());
  if constexpr (std::is_same_v<G, lie::SE3<Real>>) {
    return G(wxyz, p);
  } else if constexpr (std::is_same_v<G, lie::SO3<Real>>) {
    return G(wxyz);
  } else if constexpr (std::is_same_v<G, lie::SE2<Real>>) {
    return G(p(0), p(1), std::atan2(R(1, 0), R(0, 0)));
  } else if constexpr (G::dim == 0) {
    return G::identity();
  } else {
    return G(typename G::Tangent(p.template head<G::dim>()));
  }
}

/// Calls f with a group type over S.
template <class S, class F>
auto with_group(GroupKind group, F&& f) {
  switch (group) {
    case GroupKind::SE3:
      return f(std::type_identity<lie::SE3<S>>{});
    case GroupKind::SE2:
      return f(std::type_identity<lie::SE2<S>>{});
    case GroupKind::SO3:
      return f(std::type_identity<lie::SO3<S>>{});
    case GroupKind::R1:
      return f(std::type_identity<lie::Translation<S, 1>>{});
    case GroupKind::R2:
      return f(std::type_identity<lie::Translation<S, 2>>{});
    case GroupKind::R3:
      return f(std::type_identity<lie::Translation<S, 3>>{});
    case GroupKind::fixed:
      break;
  }
  return f(std::type_identity<lie::Trivial<S>>{});
}

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
    b -= A * given;
    DynamicMatrix<double> open = A;
    for (Eigen::Index j = 0; j < size; ++j) {
      if (named[static_cast<std::size_t>(j)] != 0) open.col(j).setZero();
    }
    const DynamicVector<double> step = ConstraintFactors<double>(open, 1e-10).solve(b);
    const double residual = (open * step - b).cwiseAbs().maxCoeff();
    if (residual > 1e-9 * std::max(1.0, given.cwiseAbs().maxCoeff())) {
      throw ModelError(
          {scene.file, 0, 0},
          fmt::format("the initial velocities violate the constraints by {:.2g}", residual),
          "leave velocities out that the constraints determine, or make the motion compatible at t = 0");
    }
    given += step;
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

/// State at t = 0; y has room for the quadratures.
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
  run.set(state.g, state.y);
  initial_velocities(scene, program, run);
  const Eigen::Index shape = run.size() - static_cast<Eigen::Index>(run.b.nu.size());
  for (std::size_t i = 0; i < run.b.nu.size(); ++i)
    state.y(shape + static_cast<Eigen::Index>(i)) = run.b.nu[i];
  return state;
}

std::vector<double> output_times(const Scene& scene) {
  if (!scene.output_times.empty()) return scene.output_times;
  std::vector<double> times;
  for (int i = 0; i <= 200; ++i) times.push_back(scene.duration * i / 200);
  return times;
}

/// Records one row: pose, shape, velocities, torques, multipliers, energies, residual.
class Recorder {
 public:
  Recorder(const SceneProgram& program, Runner<double>& run, SimulationResult& result)
      : program_(program), run_(run), result_(result) {
    auto& c = result.columns;
    c = {"t [s]"};
    const auto each = [&](const std::vector<int>& indices, const std::string& pattern) {
      for (const int i : indices) {
        if (i >= program.original.n)
          c.push_back(
              fmt::format(fmt::runtime(pattern), coordinate(i).name, coordinate(i).is_angle ? "rad" : "m"));
      }
    };
    const GroupKind group = program.model.group;
    if (group == GroupKind::SE2) c.insert(c.end(), {"x [m]", "y [m]", "theta [rad]"});
    if (group != GroupKind::SE2 && group != GroupKind::fixed)
      c.insert(c.end(), {"p_X [m]", "p_Y [m]", "p_Z [m]"});
    if (group == GroupKind::SE3 || group == GroupKind::SO3) {
      for (const char* e : {"XX", "XY", "XZ", "YX", "YY", "YZ", "ZX", "ZY", "ZZ"})
        c.push_back(fmt::format("R_{} [1]", e));
    }
    each(program.original.passive, "{} [{}]"), each(program.original.active, "{} [{}]");
    for (const int i : free_components(group))
      c.push_back(fmt::format("{} [{}]", twist_component_names[static_cast<std::size_t>(i)],
                              i < 3 ? "m/s" : "rad/s"));
    each(program.original.passive, "dot({}) [{}/s]");
    for (const int i : program.driven)
      c.push_back(fmt::format("dot({}) [{}/s]", coordinate(i).name, coordinate(i).is_angle ? "rad" : "m"));
    for (std::size_t i = 0; i < run.b.nu.size(); ++i) c.push_back(fmt::format("nu_{} [mixed]", i + 1));
    if (run.torques) {
      for (const int i : program.reduced.active)
        c.push_back(fmt::format("tau_{} [{}]", coordinate(i).name, coordinate(i).is_angle ? "N m" : "N"));
    }
    if (run.multipliers) {
      for (std::size_t i = 0; i < program.model.rows.size(); ++i)
        c.push_back(fmt::format("lambda_{} [mixed]", i + 1));
    }
    c.insert(c.end(), {"kinetic [J]", "potential [J]", "work [J]", "dissipated [J]", "energy defect [J]",
                       "constraint residual [1]"});
  }

  template <class G, class Vector>
  void operator()(double t, const G& g, const Vector& y) {
    run_.impose(t);
    run_.set(g, y);
    if (run_.rates) run_.rates();
    if (run_.torques) run_.torques();
    if (run_.multipliers) run_.multipliers();
    if (run_.energies) run_.energies();
    const Buffers<double>& b = run_.b;
    std::vector<double> row = {t};
    const auto append = [&](const std::vector<double>& v) { row.insert(row.end(), v.begin(), v.end()); };
    const GroupKind group = program_.model.group;
    if (group == GroupKind::SE2) append(b.g);
    if (group != GroupKind::SE2 && group != GroupKind::fixed) append(b.p);
    if (group == GroupKind::SE3 || group == GroupKind::SO3) append(b.R);
    append(b.r_p), append(b.r_a), append(b.eta), append(b.r_p_dot), append(b.r_d_dot), append(b.nu);
    if (run_.torques) append(b.tau_a);
    if (run_.multipliers) append(b.lambda);
    const double potential = b.gravity[0] + b.elastic[0];
    const double work = y(y.size() - 2), dissipated = y(y.size() - 1);
    if (result_.rows.empty()) initial_ = b.kinetic[0] + potential, initial_potential_ = potential;
    const double defect = b.kinetic[0] + potential - initial_ - work + dissipated;
    scale_ = std::max({scale_, b.kinetic[0], std::abs(potential - initial_potential_), std::abs(work),
                       std::abs(dissipated)});
    worst_defect_ = std::max(worst_defect_, std::abs(defect));
    result_.energy_balance = scale_ > 0 ? worst_defect_ / scale_ : 0;
    const double residual = constraint_residual();
    result_.constraint_residual = std::max(result_.constraint_residual, residual);
    result_.orthonormality = std::max(result_.orthonormality, orthonormality_defect(Eigen::Matrix3d(g.R())));
    for (const double x : {b.kinetic[0], potential, work, dissipated, defect, residual}) row.push_back(x);
    result_.rows.push_back(std::move(row));
  }

 private:
  [[nodiscard]] const Coordinate& coordinate(int velocity) const {
    return program_.model.coordinates[static_cast<std::size_t>(velocity - program_.original.n)];
  }

  double constraint_residual() {
    const auto rows = static_cast<Eigen::Index>(program_.model.rows.size());
    if (rows == 0 || !run_.constraints) return 0;
    run_.constraints();
    const Buffers<double>& b = run_.b;
    const Partition& p = program_.original;
    Eigen::MatrixXd G(rows, p.n + p.s_p() + p.s_a());
    Eigen::VectorXd v(G.cols());
    const auto put = [&](const std::vector<double>& m, int cols, int at) {
      for (Eigen::Index i = 0; i < rows; ++i) {
        for (int j = 0; j < cols; ++j) G(i, at + j) = m[static_cast<std::size_t>(i * cols + j)];
      }
    };
    put(b.A, p.n, 0), put(b.B_p, p.s_p(), p.n), put(b.B_a, p.s_a(), p.n + p.s_p());
    for (int i = 0; i < p.n; ++i) v(i) = b.eta[static_cast<std::size_t>(i)];
    for (int i = 0; i < p.s_p(); ++i) v(p.n + i) = b.r_p_dot[static_cast<std::size_t>(i)];
    std::size_t motion = 0, driven = 0;
    for (int i = 0; i < p.s_a(); ++i) {
      const bool is_driven =
          std::ranges::find(program_.driven, p.active[static_cast<std::size_t>(i)]) != program_.driven.end();
      v(p.n + p.s_p() + i) = is_driven ? b.r_d_dot[driven++] : b.r_a_dot[motion++];
    }
    return relative_constraint_residual(G, v);
  }

  const SceneProgram& program_;
  Runner<double>& run_;
  SimulationResult& result_;
  double initial_ = 0, initial_potential_ = 0, scale_ = 0, worst_defect_ = 0;
};

/// A motion that an over-constrained system cannot follow is refused, with the time.
template <class S>
std::string incompatibility(Runner<S>& run, S t) {
  if (!run.compatibility) return {};
  run.compatibility();
  for (std::size_t i = 0; i < run.b.velocity_residual.size(); ++i) {
    const double residual = static_cast<double>(run.b.velocity_residual[i]);
    if (std::abs(residual) > 1e-6)
      return fmt::format("the imposed motion violates compatibility condition {} by {:.2g} at t = {:.6g} s",
                         i + 1, residual, static_cast<double>(t));
  }
  return {};
}

}  // namespace

SimulationResult simulate_scene(const Scene& scene) {
  if (!(scene.duration > 0))
    throw ModelError({scene.file, 0, 0}, "has no duration", "add duration = <seconds>");
  const SceneProgram program = make_program(scene);
  const auto code = std::make_shared<CompiledProgram>(program.derivation->program);
  SimulationResult result;
  result.was_cached = code->was_cached();
  result.operations = program.operations;
  result.class_of_table_I = program.derivation->reduction.ranks.table_I_class(program.reduced);
  with_group<double>(program.model.group, [&]<class G>(std::type_identity<G>) {
    Runner<double> run(scene, program, code);
    integrate::State<G> state = initial_state<G>(scene, program, run, 2);
    const auto field = [&](double t, const G& g, const auto& y, auto& eta, auto& y_dot) {
      run.field(t, g, y, eta, y_dot);
    };
    Recorder record(program, run, result);
    if (std::string problem = incompatibility(run, 0.0); !problem.empty()) {
      result.status = std::move(problem);
      return;
    }
    std::vector<double> times = output_times(scene);
    const double start = cpu_now();
    if (scene.integrator.method == Integrator::Method::dopri5) {
      record(0.0, state.g, state.y);
      std::erase_if(times, [](double t) { return t <= 0; });
      integrate::DormandPrince<G> stages(state.y.size());
      integrate::AdaptiveOptions<double> options;
      options.rtol = options.atol = scene.integrator.tolerance;
      const auto outcome =
          integrate::integrate_adaptive_at(stages, field, state, std::span<const double>(times), options,
                                           [&](double t, const G& g, const auto& y) { record(t, g, y); });
      result.steps = outcome.accepted_steps, result.rejected = outcome.rejected_steps,
      result.evaluations = outcome.evaluations;
      result.finished = static_cast<bool>(outcome);
      result.status = result.finished ? "ok" : std::string(integrate::name(outcome.status));
    } else {
      integrate::Rkmk4<G> stages(state.y.size());
      record(0.0, state.g, state.y);
      result.finished = true, result.status = "ok";
      for (const double t : times) {
        if (t <= 0) continue;
        const long steps = std::max(1L, std::lround(std::ceil((t - state.t) / scene.integrator.step - 1e-9)));
        const auto outcome = integrate::integrate_fixed(stages, field, state, t, steps);
        result.steps += outcome.accepted_steps, result.evaluations += outcome.evaluations;
        if (!outcome) {
          result.finished = false, result.status = std::string(integrate::name(outcome.status));
          break;
        }
        record(t, state.g, state.y);
      }
    }
    result.cpu_seconds = cpu_now() - start;
    if (!result.finished) result.status += fmt::format(" at t = {:.6g} s", state.t);
    run.impose(state.t), run.set(state.g, state.y);
    const long repeats = 20000;
    const double timed = cpu_now();
    for (long i = 0; i < repeats && run.rates; ++i) run.rates();
    result.nanoseconds_per_evaluation = (cpu_now() - timed) / static_cast<double>(repeats) * 1e9;
  });
  return result;
}

std::vector<WorkPrecisionPoint> work_precision(const Scene& scene) {
  if (!(scene.duration > 0))
    throw ModelError({scene.file, 0, 0}, "has no duration", "add duration = <seconds>");
  const SceneProgram program = make_program(scene);
  std::vector<WorkPrecisionPoint> points;

  // reference: the tape itself in long double, far tighter
  std::vector<long double> reference;
  with_group<long double>(program.model.group, [&]<class G>(std::type_identity<G>) {
    Runner<long double> run(scene, program, &program.derivation->program);
    integrate::State<G> state = initial_state<G>(scene, program, run, 0);
    integrate::DormandPrince<G> stages(state.y.size());
    integrate::AdaptiveOptions<long double> options;
    options.rtol = options.atol = 1e-16L;
    options.max_steps = 10'000'000;
    integrate::integrate_adaptive(
        stages,
        [&](long double t, const G& g, const auto& y, auto& eta, auto& y_dot) {
          run.field(t, g, y, eta, y_dot);
        },
        state, static_cast<long double>(scene.duration), options, [](const auto&) {});
    const auto R = state.g.R();
    const auto p = state.g.p();
    for (int i = 0; i < 9; ++i) reference.push_back(R(i / 3, i % 3));
    for (int i = 0; i < 3; ++i) reference.push_back(p(i));
    for (Eigen::Index i = 0; i < run.size(); ++i) reference.push_back(state.y(i));
  });
  const auto error_of = [&](const auto& g, const auto& y, Eigen::Index shape) {
    const auto R = g.R();
    const auto p = g.p();
    double worst = 0;
    const auto compare = [&](double x, std::size_t i) {
      worst = std::isfinite(x)
                  ? std::max(worst, std::abs(x - static_cast<double>(reference[i])) /
                                        std::max(1.0, std::abs(static_cast<double>(reference[i]))))
                  : INFINITY;
    };
    for (int i = 0; i < 9; ++i) compare(R(i / 3, i % 3), static_cast<std::size_t>(i));
    for (int i = 0; i < 3; ++i) compare(p(i), static_cast<std::size_t>(9 + i));
    for (Eigen::Index i = 0; i < shape; ++i) compare(y(i), static_cast<std::size_t>(12 + i));
    return worst;
  };

  const auto code = std::make_shared<CompiledProgram>(program.derivation->program);
  const MechanismDescription description = describe_mechanism(program.model);
  std::vector<double> parameters;
  for (const Parameter& p : program.model.parameters) parameters.push_back(p.value.to_double());
  const Mechanism<double> mechanism = mechanise<double>(description, parameters);
  const Partition& p = program.reduced;
  with_group<double>(program.model.group, [&]<class G>(std::type_identity<G>) {
    for (double tolerance = 1e-3; tolerance > 1e-15; tolerance /= 10) {
      integrate::AdaptiveOptions<double> options;
      options.rtol = options.atol = tolerance;
      options.max_steps = 200'000;
      {
        Runner<double> run(scene, program, code);
        integrate::State<G> state = initial_state<G>(scene, program, run, 0);
        integrate::DormandPrince<G> stages(state.y.size());
        const double start = cpu_now();
        const auto outcome = integrate::integrate_adaptive(
            stages,
            [&](double t, const G& g, const auto& y, auto& eta, auto& y_dot) {
              run.field(t, g, y, eta, y_dot);
            },
            state, scene.duration, options, [](const auto&) {});
        points.push_back({"generated", tolerance, error_of(state.g, state.y, run.size()), cpu_now() - start,
                          outcome.evaluations, std::string(integrate::name(outcome.status))});
      }
      {  // full passive velocities, accelerations by the numeric recursion and numeric reduction
        Runner<double> run(scene, program, code);
        const integrate::State<G> reduced = initial_state<G>(scene, program, run, 0);
        if (run.kinematics) run.kinematics();
        const Eigen::Index shape = run.size() - static_cast<Eigen::Index>(run.b.nu.size());
        const auto passive = static_cast<Eigen::Index>(p.passive.size());
        integrate::State<G> state{reduced.t, reduced.g, Eigen::VectorXd::Zero(shape + passive)};
        state.y.head(shape) = reduced.y.head(shape);
        std::vector<double> v;
        for (const auto* part : {&run.b.eta, &run.b.r_p_dot, &run.b.r_d_dot})
          v.insert(v.end(), part->begin(), part->end());
        for (Eigen::Index i = 0; i < passive; ++i) state.y(shape + i) = v[static_cast<std::size_t>(i)];
        FreeDynamics<double> dynamics(mechanism);
        Eigen::VectorXd velocities_of_nu = Eigen::VectorXd::Zero(run.size());
        const auto set_velocity = [&](Eigen::Index i, double rate) {
          if (i < p.n)
            run.b.eta[static_cast<std::size_t>(i)] = rate;
          else if (i < p.n + program.original.s_p())
            run.b.r_p_dot[static_cast<std::size_t>(i - p.n)] = rate;
          else
            run.b.r_d_dot[static_cast<std::size_t>(i - p.n - program.original.s_p())] = rate;
        };
        const auto components = free_components(program.model.group);
        const auto field = [&](double t, const G& g, const auto& y, auto& eta, auto& y_dot) {
          run.impose(t);
          for (Eigen::Index i = 0; i < shape; ++i) velocities_of_nu(i) = y(i);
          for (Eigen::Index i = 0; i < passive; ++i) set_velocity(i, y(shape + i));
          if (run.imposed_torque && run.reduced_velocities)
            run.reduced_velocities();  // torques may depend on velocities
          for (std::size_t i = 0; i < run.b.nu.size(); ++i)
            velocities_of_nu(shape + static_cast<Eigen::Index>(i)) = run.b.nu[i];
          run.set(g, velocities_of_nu);
          State<double> s;
          for (std::size_t i = 0; i < 9; ++i) s.R.m[i] = run.b.R[i];
          s.p = {run.b.p[0], run.b.p[1], run.b.p[2]};
          s.t = t;
          s.r.assign(program.model.coordinates.size(), 0), s.r_dot = s.r;
          std::vector<double> r_a_ddot;
          for (std::size_t i = 0; i < p.passive.size(); ++i) {
            const double rate = y(shape + static_cast<Eigen::Index>(i));
            const int velocity = p.passive[i];
            if (velocity < p.n) {
              s.eta[components[static_cast<std::size_t>(velocity)]] = rate;
              eta(velocity) = rate;
            } else {
              s.r[static_cast<std::size_t>(velocity - p.n)] = y(static_cast<Eigen::Index>(i) - p.n);
              s.r_dot[static_cast<std::size_t>(velocity - p.n)] = rate;
              y_dot(static_cast<Eigen::Index>(i) - p.n) = rate;
            }
          }
          DynamicVector<double> active(static_cast<Eigen::Index>(p.active.size()));
          for (std::size_t i = 0; i < p.active.size(); ++i) {
            s.r[static_cast<std::size_t>(p.active[i] - p.n)] = run.b.r_m[i];
            s.r_dot[static_cast<std::size_t>(p.active[i] - p.n)] = run.b.r_m_dot[i];
            active(static_cast<Eigen::Index>(i)) = run.b.r_m_ddot[i];
          }
          const Matrix<double> M = dynamics.mass_matrix(s);
          std::vector<double> force = dynamics.forces(s);
          for (std::size_t i = 0; i < program.driven.size(); ++i)
            force[static_cast<std::size_t>(program.driven[i])] += run.b.torque[i];
          const auto [A, bias] = dynamics.constraints(s);
          std::vector<int> rows(static_cast<std::size_t>(A.rows()));
          for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<int>(i);
          DynamicVector<double> passive_force(passive);
          for (Eigen::Index i = 0; i < passive; ++i)
            passive_force(i) = force[static_cast<std::size_t>(p.passive[static_cast<std::size_t>(i)])];
          passive_force -= to_eigen(M.block(p.passive, p.active)) * active;
          const auto solution = solve_constrained<double>(
              to_eigen(M.block(p.passive, p.passive)), passive_force, to_eigen(A.block(rows, p.passive)),
              to_eigen(bias) + to_eigen(A.block(rows, p.active)) * active, 1e-10);
          for (Eigen::Index i = 0; i < passive; ++i) y_dot(shape + i) = solution.acceleration(i);
        };
        integrate::DormandPrince<G> stages(state.y.size());
        const double start = cpu_now();
        const auto outcome =
            integrate::integrate_adaptive(stages, field, state, scene.duration, options, [](const auto&) {});
        const double seconds = cpu_now() - start;
        for (Eigen::Index i = 0; i < passive; ++i)
          set_velocity(i, state.y(shape + i));  // back to nu, to compare the same
        run.impose(scene.duration);
        Eigen::VectorXd final(run.size());
        final.setZero();
        final.head(shape) = state.y.head(shape);
        run.set(state.g, final);
        if (run.reduced_velocities) run.reduced_velocities();
        for (std::size_t i = 0; i < run.b.nu.size(); ++i)
          final(shape + static_cast<Eigen::Index>(i)) = run.b.nu[i];
        points.push_back({"recursion", tolerance, error_of(state.g, final, run.size()), seconds,
                          outcome.evaluations, std::string(integrate::name(outcome.status))});
      }
    }
  });
  return points;
}

}  // namespace anholon
