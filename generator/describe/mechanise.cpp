// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/mechanise.hpp"

#include "tape/derivative.hpp"

namespace anholon {
namespace {

Vec3<Expr> vector(const std::array<Expr, 3>& a) { return {a[0], a[1], a[2]}; }
Mat3<Expr> matrix(const std::array<Expr, 9>& a) { return {a}; }

/// A joint axis turned onto coordinate axis `axis` of the body's frame: the described axis is A e_axis.
struct Alignment {
  int axis = 2;
  Mat3<Expr> A = Mat3<Expr>::identity();
};

/// Rotation that takes coordinate axis k to the unit vector a with 1 + a_k > 0.
Mat3<Expr> rotation_onto(int k, const Vec3<Expr>& a) {
  const int i = (k + 1) % 3;
  const int j = (k + 2) % 3;
  const Expr inverse = Expr(1) / (Expr(1) + a[k]);
  Mat3<Expr> A;
  A(i, i) = Expr(1) - a[i] * a[i] * inverse;
  A(j, j) = Expr(1) - a[j] * a[j] * inverse;
  A(i, j) = A(j, i) = -(a[i] * a[j] * inverse);
  A(i, k) = a[i], A(j, k) = a[j], A(k, k) = a[k];
  A(k, i) = -a[i], A(k, j) = -a[j];
  return A;
}

Mat3<Expr> half_turn_about(int k) {
  Mat3<Expr> A;
  for (int i = 0; i < 3; ++i) A(i, i) = i == k ? 1 : -1;
  return A;
}

/// Chooses the coordinate axis; `value` evaluates an expression at the default parameters.
template <class Value>
Alignment align(const Vec3<Expr>& a, const Value& value) {
  std::vector<int> nonzero;
  for (int i = 0; i < 3; ++i) {
    if (!a[i].is_zero()) nonzero.push_back(i);
  }
  if (nonzero.size() == 1) {
    const int k = nonzero[0];
    return {k, value(a[k]) > Exact(0) ? Mat3<Expr>::identity() : half_turn_about((k + 1) % 3)};
  }
  if (nonzero.size() == 2) {  // a turn about the third axis; needs no square root
    const int z = 3 - nonzero[0] - nonzero[1];
    const int i = (z + 1) % 3;
    const int j = (z + 2) % 3;
    Mat3<Expr> A;
    A(z, z) = 1;
    A(i, i) = A(j, j) = a[i];
    A(j, i) = a[j];
    A(i, j) = -a[j];
    return {i, A};
  }
  int k = 0;
  for (int i = 1; i < 3; ++i) {
    if (abs(value(a[i])) > abs(value(a[k]))) k = i;
  }
  if (value(a[k]) > Exact(0)) return {k, rotation_onto(k, a)};
  return {k, rotation_onto(k, -a) * half_turn_about((k + 1) % 3)};
}

class Describer {
 public:
  explicit Describer(const Model& model) : model_(model), tape_(*model.tape) {
    inputs_.assign(tape_.inputs().size(), Exact(0));
    for (std::size_t i = 0; i < model.parameters.size(); ++i)
      inputs_[tape_.node(model.symbols.parameters[i]).a] = model.parameters[i].value;
  }

  MechanismDescription run() {
    result_.tape = model_.tape;
    result_.symbols = model_.symbols;
    result_.group = model_.group;
    result_.coordinates = static_cast<int>(model_.coordinates.size());
    result_.gravity = vector(model_.gravity);
    for (const BodyDescription& body : model_.bodies) add(body);
    for (const RowDescription& row : model_.rows) add(row);
    for (const PositionDescription& position : model_.positions) add(position);
    for (const WrenchDescription& wrench : model_.wrenches) add(wrench);
    add_forces();
    return std::move(result_);
  }

 private:
  [[nodiscard]] Exact value(const Expr& e) const {
    return interpret<Exact>(tape_, {e.id(tape_)}, inputs_).front();
  }

  void add(const BodyDescription& b) {
    Body<Expr> body;
    body.name = b.name;
    body.parent = b.parent;
    body.kind = b.joint.kind;
    Alignment alignment;
    const bool constant = !depends_on_state(b.joint.displacement);
    if (body.kind != JointKind::fixed)
      alignment = align(vector(b.joint.axis), [this](const Expr& e) { return value(e); });
    const Mat3<Expr> parent_axes = b.parent < 0
                                       ? Mat3<Expr>::identity()
                                       : alignments_[static_cast<std::size_t>(b.parent)].A.transposed();
    const Mat3<Expr> to_body = alignment.A.transposed();
    body.axis = alignment.axis;
    body.pitch = b.joint.pitch;
    body.armature = b.joint.armature;
    body.R = parent_axes * matrix(b.R) * alignment.A;
    body.p = parent_axes * vector(b.p);
    body.R_frame = to_body;
    body.mass = b.mass;
    body.first_moment = to_body * vector(b.first_moment);
    Mat3<Expr> I;
    const auto& i = b.inertia;
    I.m = {i[0], i[3], i[4], i[3], i[1], i[5], i[4], i[5], i[2]};
    body.inertia = to_body * I * alignment.A;
    for (int row = 1; row < 3; ++row) {  // symmetric in form as well as in value
      for (int col = 0; col < row; ++col) body.inertia(row, col) = body.inertia(col, row);
    }
    for (std::size_t j = 0; j < b.modes.size(); ++j) body.modes.push_back(mode(b, j, alignment.A));
    if (b.fluid) body.fluid = b.fluid->turned_by(to_body);
    body.station = station(b, parent_axes);
    if (body.station.modes.empty()) body.p += parent_axes * vector(b.station.at);
    if (body.kind != JointKind::fixed) {
      if (constant) {
        lock(body, b.joint.displacement);
      } else {
        attach(body, b.joint.displacement);
      }
    }
    alignments_.push_back(alignment);
    result_.bodies.push_back(std::move(body));
  }

  /// Mode j in the axes that A turns into the described ones. How far T follows the deformation is decided
  /// here.
  static Mode<Expr> mode(const BodyDescription& b, std::size_t j, const Mat3<Expr>& A) {
    const ModeDescription& m = b.modes[j];
    const auto turned = [&](const Mat3<Expr>& tensor) { return A.transposed() * tensor * A; };
    Mode<Expr> mode;
    mode.coordinate = m.coordinate;
    mode.S_j = A.transposed() * vector(m.S);
    mode.N_j = turned(matrix(m.X_phi));
    for (std::size_t l = 0; l < b.modes.size(); ++l) {
      const std::array<Expr, 9>& overlap = m.phi_phi[l];
      mode.m_jl.push_back(overlap[0] + overlap[4] + overlap[8]);
      const Mat3<Expr> phi_l_phi_j = matrix(overlap).transposed();
      Mat3<Expr> N = phi_l_phi_j;
      Vec3<Expr> S;
      if (b.deformation == Deformation::linear)  // C_j = int p x phi_j dm stays as it is, dI/dr_j does not
        N = (Expr(1) / Expr(2)) * (phi_l_phi_j + Expr(-1) * phi_l_phi_j.transposed());
      if (b.deformation == Deformation::stiffened && !m.psi.empty()) {
        S = vector(m.psi[l]);
        N = N + matrix(m.X_psi[l]);
      }
      mode.S_jl.push_back(A.transposed() * S);
      mode.N_jl.push_back(turned(N));
    }
    return mode;
  }

  /// @param axes  turns components in the parent's described frame into its own
  Station<Expr> station(const BodyDescription& b, const Mat3<Expr>& axes) const {
    Station<Expr> station;
    if (b.parent < 0) return station;
    const bool foreshortens =
        model_.bodies[static_cast<std::size_t>(b.parent)].deformation == Deformation::stiffened;
    station.at = axes * vector(b.station.at);
    std::array<bool, 3> turns = {false, false, false};
    for (const StationDescription::Mode& m : b.station.modes) {
      StationMode<Expr> mode;
      mode.coordinate = m.coordinate;
      mode.phi = axes * vector(m.phi);
      mode.turn = axes * vector(m.turn);
      if (foreshortens) {
        for (const auto& psi : m.psi) mode.psi.push_back(axes * vector(psi));
      }
      for (int i = 0; i < 3; ++i)
        turns[static_cast<std::size_t>(i)] = turns[static_cast<std::size_t>(i)] || !mode.turn[i].is_zero();
      station.modes.push_back(std::move(mode));
    }
    if (std::ranges::count(turns, true) <= 1)
      station.axis = static_cast<int>(std::ranges::find(turns, true) - turns.begin()) % 3;
    return station;
  }

  [[nodiscard]] bool depends_on_state(const Expr& e) const {
    const NodeId root = e.id(tape_);
    for (const NodeId id : tape_.reachable({root})) {
      if (tape_.node(id).op == Op::input &&
          std::ranges::find(model_.symbols.parameters, id) == model_.symbols.parameters.end())
        return true;
    }
    return false;
  }

  /// A joint that stands still becomes part of the constant pose.
  static void lock(Body<Expr>& body, const Expr& q) {
    if (body.kind == JointKind::prismatic) body.p += body.R * (q * unit<Expr>(body.axis));
    if (body.kind == JointKind::helical) body.p += body.R * (body.pitch * q * unit<Expr>(body.axis));
    if (body.kind != JointKind::prismatic && !q.is_zero())
      body.R = body.R * AxisRotation<Expr>{body.axis, cos(q), sin(q)}.matrix();
    body.kind = JointKind::fixed;
    body.armature = 0;
  }

  void attach(Body<Expr>& body, const Expr& q) {
    const NodeId root = q.id(tape_);
    const auto direct = std::ranges::find(model_.symbols.r, root);
    if (direct != model_.symbols.r.end()) {
      body.coordinate = static_cast<int>(direct - model_.symbols.r.begin());
      return;
    }
    MechanismDescription::CouplingRoots coupling;
    std::vector<NodeId> gradient;
    for (std::size_t i = 0; i < model_.symbols.r.size(); ++i) {
      const NodeId d = derivative(tape_, root, model_.symbols.r[i]);
      if (tape_.is_zero(d)) continue;
      coupling.on.push_back(static_cast<int>(i));
      gradient.push_back(d);
    }
    coupling.roots = {root};
    coupling.roots.insert(coupling.roots.end(), gradient.begin(), gradient.end());
    for (const NodeId d : gradient) {
      for (const int i : coupling.on)
        coupling.roots.push_back(derivative(tape_, d, model_.symbols.r[static_cast<std::size_t>(i)]));
    }
    body.coupling = static_cast<int>(result_.couplings.size());
    result_.couplings.push_back(std::move(coupling));
  }

  void add(const RowDescription& r) {
    MechanismDescription::RowRoots row;
    row.name = r.name;
    for (const RowTermDescription& t : r.terms) {
      const Mat3<Expr> to_body = alignments_[static_cast<std::size_t>(t.body)].A.transposed();
      RowTerm<Expr> term;
      term.body = t.body;
      term.point = to_body * vector(t.point);
      term.linear = to_body * vector(t.linear);
      term.angular = to_body * vector(t.angular);
      row.terms.push_back(term);
    }
    if (r.expression) {
      const NodeId root = r.expression->id(tape_);
      std::vector<std::pair<NodeId, NodeId>> velocities;  // (velocity, coefficient)
      for (const NodeId v : model_.symbols.eta) velocities.emplace_back(v, derivative(tape_, root, v));
      for (const NodeId v : model_.symbols.r_dot) velocities.emplace_back(v, derivative(tape_, root, v));
      for (const auto& [v, coefficient] : velocities) row.roots.push_back(coefficient);
      row.roots.push_back(directional_derivative(tape_, {root}, motion()).front());
    }
    result_.rows.push_back(std::move(row));
  }

  /// Derivatives by the directions of the twist, in the reference body's axes, and by the coordinates.
  void add(const PositionDescription& position) {
    const StateSymbols& s = model_.symbols;
    const NodeId root = position.value.id(tape_);
    result_.condition_roots.push_back(root);
    for (int c = 0; c < 6; ++c)
      result_.condition_roots.push_back(directional_derivative(tape_, {root}, pose_direction(c)).front());
    for (const NodeId r : s.r) result_.condition_roots.push_back(derivative(tape_, root, r));
  }

  /// Tangent of the pose along component c of the twist: R_dot = R [e], p_dot = R e.
  std::vector<std::pair<NodeId, NodeId>> pose_direction(int c) {
    const StateSymbols& s = model_.symbols;
    Mat3<Expr> R;
    for (std::size_t i = 0; i < 9; ++i) R.m[i] = Expr(tape_, s.R[i]);
    const Vec3<Expr> e = unit<Expr>(c % 3);
    std::vector<std::pair<NodeId, NodeId>> direction;
    if (c < 3) {
      const Vec3<Expr> p_dot = R * e;
      for (int i = 0; i < 3; ++i)
        direction.emplace_back(s.p[static_cast<std::size_t>(i)], p_dot[i].id(tape_));
    } else {
      const Mat3<Expr> R_dot = R * skew(e);
      for (std::size_t i = 0; i < 9; ++i) direction.emplace_back(s.R[i], R_dot.m[i].id(tape_));
    }
    return direction;
  }

  /// d/dt at constant velocities: R_dot = R [Omega], p_dot = R V, r_dot, t_dot = 1.
  std::vector<std::pair<NodeId, NodeId>> motion() {
    const StateSymbols& s = model_.symbols;
    std::vector<std::pair<NodeId, NodeId>> direction = {{s.t, tape_.constant(1)}};
    Mat3<Expr> R;
    for (std::size_t i = 0; i < 9; ++i) R.m[i] = Expr(tape_, s.R[i]);
    const auto eta = [&](std::size_t i) { return Expr(tape_, s.eta[i]); };
    const Mat3<Expr> R_dot = R * skew(Vec3<Expr>{eta(3), eta(4), eta(5)});
    const Vec3<Expr> p_dot = R * Vec3<Expr>{eta(0), eta(1), eta(2)};
    for (std::size_t i = 0; i < 9; ++i) direction.emplace_back(s.R[i], R_dot.m[i].id(tape_));
    for (std::size_t i = 0; i < 3; ++i) direction.emplace_back(s.p[i], p_dot[static_cast<int>(i)].id(tape_));
    for (std::size_t i = 0; i < s.r.size(); ++i) direction.emplace_back(s.r[i], s.r_dot[i]);
    return direction;
  }

  void add(const WrenchDescription& w) {
    const Mat3<Expr> to_body = alignments_[static_cast<std::size_t>(w.body)].A.transposed();
    MechanismDescription::WrenchRoots wrench;
    wrench.form = {w.body, w.in_world_axes, w.dissipates, to_body * vector(w.point), to_body, {}};
    for (const Expr& e : w.force) wrench.roots.push_back(e.id(tape_));
    for (const Expr& e : w.torque) wrench.roots.push_back(e.id(tape_));
    result_.wrenches.push_back(std::move(wrench));
  }

  /// Q = -dU/dr - dD/dr_dot, eq. (21), plus the user's own; likewise for the reference body, whose directions
  /// are those of its own axes.
  void add_forces() {
    const StateSymbols& s = model_.symbols;
    const NodeId U = model_.potential.id(tape_);
    const NodeId D = model_.dissipation.id(tape_);
    std::vector<Expr> force(6 + s.r.size(), Expr(0));
    Expr power = 0;
    for (std::size_t c = 0; c < 6; ++c) {
      const Expr damping(tape_, derivative(tape_, D, s.eta[c]));
      const NodeId slope = directional_derivative(tape_, {U}, pose_direction(static_cast<int>(c))).front();
      force[c] = -Expr(tape_, slope) - damping;
      power = power + Expr(tape_, s.eta[c]) * damping;
    }
    for (std::size_t i = 0; i < s.r.size(); ++i) {
      const Expr damping(tape_, derivative(tape_, D, s.r_dot[i]));
      force[6 + i] = -Expr(tape_, derivative(tape_, U, s.r[i])) - damping;
      power = power + Expr(tape_, s.r_dot[i]) * damping;
    }
    Expr applied = 0;
    for (const GeneralisedForceDescription& f : model_.forces) {
      const auto index = static_cast<std::size_t>(f.index);
      force[index] += f.force;
      const Expr of_force = f.force * Expr(tape_, index < 6 ? s.eta[index] : s.r_dot[index - 6]);
      if (f.dissipates) {
        power = power - of_force;
      } else {
        applied = applied + of_force;
      }
    }
    if (std::ranges::any_of(force, [](const Expr& e) { return !e.is_zero(); })) {
      for (const Expr& e : force) result_.force_roots.push_back(e.id(tape_));
    }
    if (!model_.potential.is_zero() || !power.is_zero() || !applied.is_zero())
      result_.energy_roots = {U, power.id(tape_), applied.id(tape_)};
  }

  const Model& model_;
  Tape& tape_;
  std::vector<Exact> inputs_;
  std::vector<Alignment> alignments_;
  MechanismDescription result_;
};

}  // namespace

MechanismDescription describe_mechanism(const Model& model) { return Describer(model).run(); }

}  // namespace anholon
