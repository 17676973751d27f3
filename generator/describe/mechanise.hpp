// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// From a description to a Mechanism over any scalar. The description is first brought to the mechanism's form
// on its own tape (joint axes along coordinate axes; forces, rows and couplings differentiated); that form is
// then run over the scalar: numbers for the constants, a callable for what depends on the state.

#include <algorithm>
#include <memory>
#include <vector>

#include "anholon/mechanism.hpp"
#include "describe/model.hpp"
#include "tape/interpret.hpp"

namespace anholon {

/// A description in the form of a mechanism, still on the description's tape.
struct MechanismDescription {
  struct CouplingRoots {
    std::vector<int> on;
    std::vector<NodeId> roots;  // c, gradient, Hessian
  };
  struct RowRoots {
    std::string name;
    std::vector<RowTerm<Expr>> terms;
    std::vector<NodeId> roots;  // of a written row: 6 + s coefficients, bias
  };
  struct WrenchRoots {
    AppliedWrench<Expr> form;   // but for what evaluates it
    std::vector<NodeId> roots;  // force, torque
  };
  std::shared_ptr<Tape> tape;
  StateSymbols symbols;
  GroupKind group = GroupKind::fixed;
  int coordinates = 0;
  std::vector<Body<Expr>> bodies;
  std::vector<CouplingRoots> couplings;
  std::vector<RowRoots> rows;
  std::vector<NodeId> condition_roots;  // of each condition on the position: value, 6 + s derivatives
  Vec3<Expr> gravity;
  std::vector<WrenchRoots> wrenches;
  std::vector<NodeId> force_roots;  // 6 + s, empty where all vanish
  std::vector<NodeId>
      energy_roots;  // potential, dissipated power, power of generalised forces; empty where all vanish
};

/// Brings a description to mechanism form. Adds derivative nodes to the model's tape.
MechanismDescription describe_mechanism(const Model& model);

namespace detail {

/// Runs roots of a description's tape over S at given parameters and state.
template <class S>
class StateFunction {
 public:
  StateFunction(const MechanismDescription& d, std::vector<NodeId> roots, std::vector<S> parameters,
                FromExact<S> constant)
      : symbols_(d.symbols), interpreter_(*d.tape, roots, constant), inputs_(d.tape->inputs().size(), S(0)) {
    for (std::size_t i = 0; i < parameters.size(); ++i) set(*d.tape, symbols_.parameters[i], parameters[i]);
    const auto index = [&](NodeId id) { return static_cast<std::size_t>(d.tape->node(id).a); };
    t_ = index(symbols_.t);
    for (std::size_t i = 0; i < 9; ++i) R_[i] = index(symbols_.R[i]);
    for (std::size_t i = 0; i < 3; ++i) p_[i] = index(symbols_.p[i]);
    for (std::size_t i = 0; i < 6; ++i) eta_[i] = index(symbols_.eta[i]);
    for (const NodeId id : symbols_.r) r_.push_back(index(id));
    for (const NodeId id : symbols_.r_dot) r_dot_.push_back(index(id));
    for (const NodeId id : symbols_.local) local_.push_back(index(id));
  }
  void operator()(const State<S>& state, const Spatial<S>& local, std::span<S> out) {
    for (std::size_t i = 0; i < local_.size(); ++i) inputs_[local_[i]] = local[static_cast<int>(i)];
    (*this)(state, out);
  }
  void operator()(const State<S>& state, std::span<S> out) {
    inputs_[t_] = state.t;
    for (std::size_t i = 0; i < 9; ++i) inputs_[R_[i]] = state.R.m[i];
    for (std::size_t i = 0; i < 3; ++i) inputs_[p_[i]] = state.p[static_cast<int>(i)];
    for (std::size_t i = 0; i < 6; ++i) inputs_[eta_[i]] = state.eta[static_cast<int>(i)];
    for (std::size_t i = 0; i < r_dot_.size(); ++i) inputs_[r_dot_[i]] = state.r_dot[i];
    (*this)(std::span<const S>(state.r), out);
  }
  void operator()(std::span<const S> r, std::span<S> out) {
    for (std::size_t i = 0; i < r_.size(); ++i) inputs_[r_[i]] = r[i];
    interpreter_(inputs_, out);
  }

 private:
  void set(const Tape& tape, NodeId id, const S& value) { inputs_[tape.node(id).a] = value; }
  StateSymbols symbols_;
  Interpreter<S> interpreter_;
  std::vector<S> inputs_;
  std::size_t t_ = 0;
  std::array<std::size_t, 9> R_{};
  std::array<std::size_t, 3> p_{};
  std::array<std::size_t, 6> eta_{};
  std::vector<std::size_t> r_, r_dot_, local_;
};

}  // namespace detail

/// Mechanism over S. The description must outlive nothing: the callables keep what they need.
/// @param parameters  one value for each parameter of the model
template <class S>
Mechanism<S> mechanise(const MechanismDescription& d, const std::vector<S>& parameters,
                       FromExact<S> constant = {}) {
  std::vector<S> inputs(d.tape->inputs().size(), S(0));
  for (std::size_t i = 0; i < parameters.size(); ++i)
    inputs[d.tape->node(d.symbols.parameters[i]).a] = parameters[i];
  std::vector<NodeId> roots;  // every constant of the mechanism, evaluated in one pass
  const auto want = [&](const Expr& e) { roots.push_back(e.id(*d.tape)); };
  const auto want3 = [&](const Vec3<Expr>& v) {
    for (int i = 0; i < 3; ++i) want(v[i]);
  };
  const auto want9 = [&](const Mat3<Expr>& m) {
    for (const Expr& e : m.m) want(e);
  };
  const auto visit = [&](auto&& scalar, auto&& vector, auto&& matrix) {
    for (const Body<Expr>& b : d.bodies) {
      scalar(b.pitch), scalar(b.armature), matrix(b.R), vector(b.p), matrix(b.R_frame), scalar(b.mass),
          vector(b.first_moment), matrix(b.inertia);
      if (b.fluid) {
        vector(b.fluid->A.diagonal), vector(b.fluid->A.mixed), matrix(b.fluid->B);
        vector(b.fluid->C.diagonal), vector(b.fluid->C.mixed);
        scalar(b.fluid->displaced), vector(b.fluid->displaced_moment);
      }
      for (const Mode<Expr>& mode : b.modes) {
        vector(mode.S_j), matrix(mode.N_j);
        for (const Expr& m : mode.m_jl) scalar(m);
        for (const Vec3<Expr>& v : mode.S_jl) vector(v);
        for (const Mat3<Expr>& m : mode.N_jl) matrix(m);
      }
      vector(b.station.at);
      for (const StationMode<Expr>& mode : b.station.modes) {
        vector(mode.phi), vector(mode.turn);
        for (const Vec3<Expr>& v : mode.psi) vector(v);
      }
    }
    for (const auto& row : d.rows) {
      for (const auto& term : row.terms) vector(term.point), vector(term.linear), vector(term.angular);
    }
    vector(d.gravity);
    for (const auto& wrench : d.wrenches) vector(wrench.form.point), matrix(wrench.form.axes);
  };
  visit(want, want3, want9);
  const std::vector<S> values = interpret<S>(*d.tape, roots, inputs, constant);

  std::size_t next = 0;
  const auto scalar = [&] { return values[next++]; };
  const auto vector = [&] {
    Vec3<S> v;
    for (int i = 0; i < 3; ++i) v[i] = scalar();
    return v;
  };
  const auto matrix = [&] {
    Mat3<S> m;
    for (S& e : m.m) e = scalar();
    return m;
  };
  Mechanism<S> mechanism;
  mechanism.group = d.group;
  mechanism.coordinates = d.coordinates;
  for (const Body<Expr>& b : d.bodies) {
    Body<S> body;
    body.name = b.name;
    body.parent = b.parent;
    body.kind = b.kind;
    body.axis = b.axis;
    body.coordinate = b.coordinate;
    body.coupling = b.coupling;
    body.pitch = scalar(), body.armature = scalar(), body.R = matrix(), body.p = vector(),
    body.R_frame = matrix();
    body.mass = scalar(), body.first_moment = vector(), body.inertia = matrix();
    if (b.fluid) {
      AddedMass<S> fluid;
      fluid.A.diagonal = vector(), fluid.A.mixed = vector(), fluid.B = matrix();
      fluid.C.diagonal = vector(), fluid.C.mixed = vector();
      fluid.displaced = scalar(), fluid.displaced_moment = vector();
      body.fluid = fluid;
    }
    for (const Mode<Expr>& m : b.modes) {
      Mode<S> mode;
      mode.coordinate = m.coordinate;
      mode.S_j = vector(), mode.N_j = matrix();
      for (std::size_t l = 0; l < m.m_jl.size(); ++l) mode.m_jl.push_back(scalar());
      for (std::size_t l = 0; l < m.S_jl.size(); ++l) mode.S_jl.push_back(vector());
      for (std::size_t l = 0; l < m.N_jl.size(); ++l) mode.N_jl.push_back(matrix());
      body.modes.push_back(std::move(mode));
    }
    body.station.axis = b.station.axis;
    body.station.at = vector();
    for (const StationMode<Expr>& m : b.station.modes) {
      StationMode<S> mode;
      mode.coordinate = m.coordinate;
      mode.phi = vector(), mode.turn = vector();
      for (std::size_t l = 0; l < m.psi.size(); ++l) mode.psi.push_back(vector());
      body.station.modes.push_back(std::move(mode));
    }
    mechanism.bodies.push_back(std::move(body));
  }
  const auto state_function = [&](const std::vector<NodeId>& of) {
    return [f = std::make_shared<detail::StateFunction<S>>(d, of, parameters, constant)](
               const auto& at, std::span<S> out) { (*f)(at, out); };
  };
  for (const auto& c : d.couplings) mechanism.couplings.push_back({c.on, state_function(c.roots)});
  for (const auto& r : d.rows) {
    ConstraintRow<S> row;
    row.name = r.name;
    for (const auto& t : r.terms) {
      RowTerm<S> term;
      term.body = t.body;
      term.point = vector(), term.linear = vector(), term.angular = vector();
      row.terms.push_back(term);
    }
    if (!r.roots.empty()) row.written = state_function(r.roots);
    mechanism.rows.push_back(std::move(row));
  }
  mechanism.conditions = static_cast<int>(d.condition_roots.size()) / (7 + d.coordinates);
  if (!d.condition_roots.empty()) mechanism.position_conditions = state_function(d.condition_roots);
  mechanism.gravity = vector();
  for (const auto& w : d.wrenches) {
    AppliedWrench<S> wrench;
    wrench.body = w.form.body;
    wrench.in_world_axes = w.form.in_world_axes;
    wrench.dissipates = w.form.dissipates;
    wrench.point = vector(), wrench.axes = matrix();
    wrench.evaluate = [f = std::make_shared<detail::StateFunction<S>>(d, w.roots, parameters, constant)](
                          const State<S>& state, const Spatial<S>& velocity, std::span<S> out) {
      (*f)(state, velocity, out);
    };
    mechanism.wrenches.push_back(std::move(wrench));
  }
  if (!d.force_roots.empty()) mechanism.generalised_forces = state_function(d.force_roots);
  if (!d.energy_roots.empty()) mechanism.user_energies = state_function(d.energy_roots);
  return mechanism;
}

}  // namespace anholon
