// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/tree_quantities.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "anholon/articulated.hpp"
#include "anholon/factor.hpp"
#include "derive/derive.hpp"
#include "derive/loop_tables.hpp"
#include "derive/tree_kinematics.hpp"
#include "describe/mechanise.hpp"
#include "optimise/model/merge_fixed.hpp"

namespace anholon {
namespace {

std::vector<Expr> six(const Spatial<Expr>& x) {
  std::vector<Expr> v;
  for (int i = 0; i < 6; ++i) v.push_back(x[i]);
  return v;
}

}  // namespace

TreeQuantities::TreeQuantities(const Model& model, Program& program)
    : model_(model), tape_(program.tape), in_(model, program) {
  const MechanismDescription description = describe_mechanism(model);
  if (!description.rows.empty() || !description.wrenches.empty())
    throw UnsupportedError(fmt::format(
        "model '{}' has constraints or external wrenches: its functions are those of derive()", model.name));
  described_ = mechanise<Expr>(description, in_.parameters, FromExact<Expr>{&tape_});
  for (const Body<Expr>& b : described_.bodies) {
    if (!b.modes.empty())
      throw UnsupportedError(fmt::format(
          "body '{}' is compliant: the functions of model '{}' are those of derive()", b.name, model.name));
    if (b.fluid)
      throw UnsupportedError(fmt::format(
          "body '{}' has added mass: the functions of model '{}' are those of derive()", b.name, model.name));
  }
  described_.open_section = [this](const std::string& title) { tape_.section(title); };
  merged_ = described_;
  merged_bodies_ = merge_fixed(merged_);
}

OutputBlock TreeQuantities::block(std::string name, std::string unit, std::string meaning,
                                  const std::vector<Expr>& v) {
  OutputBlock b{std::move(name), std::move(unit), std::move(meaning), static_cast<int>(v.size()), 1, {}};
  for (const Expr& e : v) b.nodes.push_back(e.id(tape_));
  return b;
}
OutputBlock TreeQuantities::block(std::string name, std::string unit, std::string meaning,
                                  const Matrix<Expr>& m) {
  OutputBlock b = block(std::move(name), std::move(unit), std::move(meaning), m.entries());
  b.rows = m.rows();
  b.cols = m.cols();
  return b;
}

std::vector<OutputBlock> TreeQuantities::blocks_of(const std::string& name,
                                                   const std::vector<std::vector<Expr>>& values) {
  std::vector<OutputBlock> blocks;
  if (name == "mass_factor") {
    blocks = {block("L", "mixed", "unit lower triangular", values[0]),
              block("D", "mixed", "diagonal", values[1])};
    blocks[0].rows = blocks[0].cols = blocks[1].rows;
  } else if (name == "inverse_mass_matrix") {
    blocks = {block("M_inverse", "mixed", "(eta, r) x (eta, r)", values[0])};
    blocks[0].rows = blocks[0].cols = n() + static_cast<int>(in_.r.size());
  } else {
    std::string names;
    for (const Body<Expr>& b : merged_.bodies) names += (names.empty() ? "" : ", ") + b.name;
    blocks = {
        block("Y", "mixed", "columns m, mx, my, mz, Ixx, Iyy, Izz, Ixy, Ixz, Iyz of " + names, values[0])};
    blocks[0].rows = n() + static_cast<int>(in_.r.size());
    blocks[0].cols = 10 * static_cast<int>(merged_.bodies.size());
  }
  return blocks;
}

std::vector<TreeRoute> TreeQuantities::routes(const std::string& name) {
  using M = const Mechanism<Expr>&;
  if (name == "inverse_dynamics")
    return {
        {"", [this](M m) { return inverse_dynamics(m, in_.eta, in_.eta_dot, in_.r_dot, in_.r_ddot, true); }}};
  if (name == "bias_forces")
    return {{"", [this](M m) { return inverse_dynamics(m, in_.eta, {}, in_.r_dot, zeros(), true); }}};
  if (name == "gravity_forces")
    return {{"", [this](M m) { return inverse_dynamics(m, {}, {}, zeros(), zeros(), false); }}};
  if (name == "mass_matrix")
    return {{"", [this](M m) {
               return std::vector{block("M", "kg, kg m, kg m^2", "(eta, r) x (eta, r)", mass_matrix(m))};
             }}};
  if (name == "forward_dynamics") {
    return {{"articulated bodies",
             [this](M m) { return independent(m) ? forward_dynamics(m, true) : std::vector<OutputBlock>{}; }},
            {"composite bodies and LTDL factor", [this](M m) {
               return factor_may_pay(m) ? forward_dynamics(m, false) : std::vector<OutputBlock>{};
             }}};
  }
  if (name == "imposed_motion")
    return {{"composite body and two sweeps", [this](M m) { return imposed_motion(m); }}};
  if (name == "mass_factor") {
    return {{"composite bodies", [this](M m) {
               const LtdlFactor<Expr> f = ltdl(mass_matrix(m));
               Matrix<Expr> L = f.L;
               for (int i = 0; i < L.rows(); ++i) L(i, i) = 1;
               return blocks_of("mass_factor", {L.entries(), f.D});
             }}};
  }
  if (name == "inverse_mass_matrix")
    return {{"LTDL factor, unit columns", [this](M m) { return inverse_mass_matrix(m); }}};
  if (name == "centroidal_momentum") {
    return {{"composite bodies", [this](M m) {
               const CentroidalMomentum<Expr> c = centroidal_momentum(m, in_.state());
               return std::vector{
                   block("momentum", "kg m/s, kg m^2/s",
                         "linear, and angular about the centre of mass, world axes", six(c.momentum)),
                   block("centre", "m", "centre of mass in the world",
                         std::vector{c.centre.x, c.centre.y, c.centre.z})};
             }}};
  }
  if (name == "energies") {
    return {{"", [this](M m) {
               const auto e = FreeDynamics<Expr>(m).energies(in_.state());
               return std::vector{
                   block("kinetic", "J", "kinetic energy", std::vector{e.kinetic}),
                   block("gravity", "J", "potential energy of gravity, zero at the origin of the world",
                         std::vector{e.gravity}),
                   block("elastic", "J", "energy of springs", std::vector{e.elastic}),
                   block("dissipated_power", "W", "lost in dampers", std::vector{e.dissipated_power})};
             }}};
  }
  if (name == "forward_kinematics") return {{"", [this](M) { return forward_kinematics(); }, false}};
  if (name == "jacobians") return {{"", [this](M) { return jacobians(); }, false}};
  if (name == "regressor") return {{"", [this](M) { return regressors(); }, false}};
  if (name == regressor_motion) return {{"", [this](M) { return regressor_motions(); }, false}};
  throw std::logic_error("a function without a derivation");
}

/// Whether the LTDL factor may take less than the articulated bodies: it grows with the squares of the
/// depths, they with the number of bodies, of which none takes 400 operations.
bool TreeQuantities::factor_may_pay(const Mechanism<Expr>& m) const {
  if (!independent(m)) return true;
  std::vector<double> depth(m.bodies.size(), n());
  double operations = 0;
  for (std::size_t k = 1; k < m.bodies.size(); ++k) {
    const double above = depth[static_cast<std::size_t>(m.bodies[k].parent)];
    depth[k] = above + 1;
    operations += above * above;  // a multiplication and a subtraction for each pair above
  }
  return operations < 400.0 * static_cast<double>(m.bodies.size());
}

bool TreeQuantities::independent(const Mechanism<Expr>& m) const {
  RigidTree<Expr> tree(m);
  tree.position(in_.r);
  return joints_are_independent(tree);
}

std::string TreeQuantities::meaning(const std::string& name) const {
  if (name == "inverse_dynamics")
    return "Joint forces and, for a moving reference body, the wrench on it that a motion needs.";
  if (name == "bias_forces")
    return "What inverse dynamics needs without accelerations: Coriolis, centrifugal and gravity forces, "
           "friction.";
  if (name == "gravity_forces")
    return "What gravity alone asks of the joints and of the reference body, at rest.";
  if (name == "mass_matrix") return "Mass matrix M of (eta, r_dot).";
  if (name == "forward_dynamics") return "Accelerations under joint forces tau.";
  if (name == "imposed_motion")
    return "Acceleration of a free reference body and forces of the joints under imposed joint motion.";
  if (name == "mass_factor") return "M = L^T D L.";
  if (name == "inverse_mass_matrix") return "Inverse of M.";
  if (name == "centroidal_momentum") return "Momentum of the robot about its centre of mass.";
  if (name == "energies") return "Kinetic and potential energy, power lost.";
  if (name == "forward_kinematics") return "Poses of all links in the world, R row-major and p.";
  if (name == "jacobians")
    return "Twists of the links at the tips in their own axes: J (eta, r_dot); their derivative is J "
           "(eta_dot, r_ddot) + bias.";
  if (name == "regressor")
    return fmt::format(
        "Inverse dynamics without springs, dampers{} as Y pi, linear in the inertial figures pi of the "
        "bodies.",
        has_armatures() ? ", friction and armatures" : " and friction");
  if (name == regressor_motion) return "Motion of bodies and joints, from which regressor() starts.";
  return "";
}

bool TreeQuantities::has_armatures() const {
  return std::ranges::any_of(merged_.bodies, [](const Body<Expr>& b) { return !b.armature.is_zero(); });
}

std::vector<Expr> TreeQuantities::free_part(const Spatial<Expr>& x) const {
  std::vector<Expr> v;
  for (const int c : free_components(model_.group)) v.push_back(x[c]);
  return v;
}

/// Springs, dampers and friction: generalised forces of the coordinates; empty where there are none.
std::vector<Expr> TreeQuantities::own_forces(const Mechanism<Expr>& m, const Spatial<Expr>& eta,
                                             const std::vector<Expr>& r_dot) const {
  if (!m.generalised_forces) return {};
  State<Expr> state = in_.state();
  state.eta = eta;
  state.r_dot = r_dot;
  std::vector<Expr> force(6 + r_dot.size(), Expr(0));
  m.section("springs, dampers and friction");
  m.generalised_forces(state, force);
  return force;
}

/// Generalised forces in the order (reference body, coordinates) of a motion whose base acceleration is a.
std::pair<Spatial<Expr>, std::vector<Expr>> TreeQuantities::sweep(
    const Mechanism<Expr>& m, const Spatial<Expr>& eta, const Vec3<Expr>& wd, const Vec3<Expr>& a,
    const std::vector<Expr>& r_dot, const std::vector<Expr>& r_ddot, bool own) const {
  RigidTree<Expr> tree(m);
  tree.position(in_.r);
  tree.move_base(eta.angular, wd, a);
  tree.move(r_dot, r_ddot);
  Spatial<Expr> base;
  std::vector<Expr> force = tree.inverse_dynamics(base);
  if (!own) return {base, force};
  const std::vector<Expr> applied = own_forces(m, eta, r_dot);
  for (std::size_t i = 0; i < applied.size(); ++i) {
    if (i < 6) base[static_cast<int>(i)] = base[static_cast<int>(i)] - applied[i];
    if (i >= 6) force[i - 6] -= applied[i];
  }
  return {base, force};
}

std::vector<OutputBlock> TreeQuantities::inverse_dynamics(const Mechanism<Expr>& m, const Spatial<Expr>& eta,
                                                          const Spatial<Expr>& eta_dot,
                                                          const std::vector<Expr>& r_dot,
                                                          const std::vector<Expr>& r_ddot, bool own) {
  m.section(m.bodies[0].name + ": acceleration");
  const Vec3<Expr> a = eta_dot.linear + cross(eta.angular, eta.linear) - transposed_times(in_.R, m.gravity);
  const auto [base, force] = sweep(m, eta, eta_dot.angular, a, r_dot, r_ddot, own);
  return {block("base_wrench", "N, N m", "on the reference body about its origin, in its own axes",
                free_part(base)),
          block("tau", "N m or N", "forces of the joints", force)};
}

/// The free components of the base acceleration vanish in a first sweep; what that sweep leaves on the base
/// is balanced by the inertia of all bodies taken as one. Empty for a fixed reference body.
std::vector<OutputBlock> TreeQuantities::imposed_motion(const Mechanism<Expr>& m) {
  if (n() == 0) return {};
  const auto components = free_components(model_.group);
  const Vec3<Expr> drift = cross(in_.eta.angular, in_.eta.linear) - transposed_times(in_.R, m.gravity);
  const Spatial<Expr> wrench = sweep(m, in_.eta, {}, drift, in_.r_dot, in_.r_ddot, true).first;
  const Matrix<Expr> M = mass_matrix(m);
  Matrix<Expr> base(n(), n());
  std::vector<Expr> b;
  for (int i = 0; i < n(); ++i) {
    for (int j = 0; j < n(); ++j) base(i, j) = M(i, j);
    b.push_back(-wrench[components[static_cast<std::size_t>(i)]]);
  }
  m.section("acceleration of the reference body");
  const std::vector<Expr> x = ltdl(base).solve(b);
  Spatial<Expr> eta_dot;
  for (std::size_t i = 0; i < x.size(); ++i) eta_dot[components[i]] = x[i];
  const std::vector<Expr> tau =
      sweep(m, in_.eta, eta_dot.angular, eta_dot.linear + drift, in_.r_dot, in_.r_ddot, true).second;
  return {block("eta_dot", "m/s^2, rad/s^2", "derivative of eta", x),
          block("tau", "N m or N", "forces of the joints", tau)};
}

Matrix<Expr> TreeQuantities::mass_matrix(const Mechanism<Expr>& m) const {
  RigidTree<Expr> tree(m);
  tree.position(in_.r);
  return composite_mass_matrix(tree);
}

std::vector<OutputBlock> TreeQuantities::inverse_mass_matrix(const Mechanism<Expr>& m) {
  const LtdlFactor<Expr> factor = ltdl(mass_matrix(m));
  const int size = factor.L.rows();
  Matrix<Expr> inverse(size, size);
  for (int c = 0; c < size; ++c) {
    std::vector<Expr> e(static_cast<std::size_t>(size), Expr(0));
    e[static_cast<std::size_t>(c)] = 1;
    const std::vector<Expr> x = factor.solve(e);
    for (int i = 0; i <= c; ++i) inverse(i, c) = inverse(c, i) = x[static_cast<std::size_t>(i)];
  }
  return blocks_of("inverse_mass_matrix", {inverse.entries()});
}

std::vector<OutputBlock> TreeQuantities::forward_kinematics() {
  std::vector<Mat3<Expr>> R;
  std::vector<Vec3<Expr>> p;
  FreeDynamics<Expr>(described_).poses(in_.state(), R, p);
  std::vector<OutputBlock> outputs;
  for (std::size_t k = 0; k < R.size(); ++k) {
    const std::string& name = described_.bodies[k].name;
    outputs.push_back(block("R_" + name, "1", "orientation of link " + name,
                            std::vector<Expr>(R[k].m.begin(), R[k].m.end())));
    outputs.back().rows = outputs.back().cols = 3;
    outputs.push_back(block("p_" + name, "m", "origin of link " + name, std::vector{p[k].x, p[k].y, p[k].z}));
  }
  return outputs;
}

std::vector<OutputBlock> TreeQuantities::jacobians() {
  std::vector<int> tips;
  for (std::size_t k = 0; k < described_.bodies.size(); ++k) {
    const bool is_parent = std::ranges::any_of(
        described_.bodies, [&](const Body<Expr>& b) { return b.parent == static_cast<int>(k); });
    if (!is_parent) tips.push_back(static_cast<int>(k));
  }
  const std::vector<FrameJacobian<Expr>> frames = frame_jacobians(described_, in_.state(), tips);
  std::vector<OutputBlock> outputs;
  for (std::size_t i = 0; i < tips.size(); ++i) {
    const std::string& name = described_.bodies[static_cast<std::size_t>(tips[i])].name;
    outputs.push_back(block("J_" + name, "mixed", "6 x (eta, r)", frames[i].J));
    outputs.push_back(block("bias_" + name, "m/s^2, rad/s^2", "linear part first", frames[i].bias));
  }
  return outputs;
}

/// The tree without fixed joints in the described frames, moving as the inputs say.
RigidTree<Expr> TreeQuantities::moving_tree() const {
  RigidTree<Expr> tree(merged_);
  tree.position(in_.r);
  tree.move_base(
      in_.eta.angular, in_.eta_dot.angular,
      in_.eta_dot.linear + cross(in_.eta.angular, in_.eta.linear) - transposed_times(in_.R, merged_.gravity));
  tree.move(in_.r_dot, in_.r_ddot);
  return tree;
}

std::vector<OutputBlock> TreeQuantities::regressors() {
  return blocks_of("regressor", {regressor(moving_tree()).entries()});
}

/// What the loops of the regressor start from.
std::vector<OutputBlock> TreeQuantities::regressor_motions() {
  const RegressorMotion m = motion_for_regressor(moving_tree());
  std::vector<OutputBlock> blocks = {
      block("motion", "mixed",
            "of each body: orientation and place in the reference body's frame, angular velocity, its "
            "derivative, "
            "acceleration minus gravity in its own",
            m.motion),
      block("axes", "mixed", "of each body's joint: twist at unit rate in the reference body's frame",
            m.axes)};
  for (OutputBlock& b : blocks) {
    b.rows = static_cast<int>(merged_.bodies.size());
    b.cols = static_cast<int>(b.nodes.size()) / b.rows;
  }
  return blocks;
}

/// With A = eta_dot.linear + Omega x V - R^T gravity as the unknown of a free reference body, gravity drops
/// out of all but the last line; a reference body that cannot accelerate everywhere carries gravity as its
/// own acceleration.
std::vector<OutputBlock> TreeQuantities::forward_dynamics(const Mechanism<Expr>& m, bool articulated_bodies) {
  m.section(m.bodies[0].name + ": acceleration");
  const Vec3<Expr> drift = cross(in_.eta.angular, in_.eta.linear) - transposed_times(in_.R, m.gravity);
  const auto components = free_components(model_.group);
  const bool is_free = model_.group == GroupKind::SE3;
  const Vec3<Expr> a = is_free ? Vec3<Expr>{} : drift;
  const std::vector<Expr> applied = own_forces(m, in_.eta, in_.r_dot);
  std::vector<Expr> tau = in_.tau;
  for (std::size_t i = 6; i < applied.size(); ++i) tau[i - 6] += applied[i];
  Spatial<Expr> eta_dot;
  std::vector<Expr> r_ddot;
  if (articulated_bodies) {
    RigidTree<Expr> tree(m);
    tree.position(in_.r);
    tree.move_base(in_.eta.angular, {}, a);
    tree.move(in_.r_dot, zeros());
    TreeAcceleration<Expr> result = articulated_acceleration(tree, tau);
    eta_dot = result.base;
    r_ddot = std::move(result.r_ddot);
  } else {
    const auto [base, force] = sweep(m, in_.eta, {}, a, in_.r_dot, zeros(), false);
    const Matrix<Expr> M = mass_matrix(m);
    m.section("factor and solution");
    std::vector<Expr> b;
    for (const int c : components) b.push_back(-base[c]);
    for (std::size_t i = 0; i < tau.size(); ++i) b.push_back(tau[i] - force[i]);
    const std::vector<Expr> x = ltdl(M).solve(b);
    for (std::size_t i = 0; i < components.size(); ++i) eta_dot[components[i]] = x[i];
    r_ddot.assign(x.begin() + n(), x.end());
  }
  if (is_free) eta_dot.linear -= drift;
  return {block("eta_dot", "m/s^2, rad/s^2", "derivative of eta", free_part(eta_dot)),
          block("r_ddot", "rad/s^2 or m/s^2", "second derivatives of r", r_ddot)};
}

}  // namespace anholon
