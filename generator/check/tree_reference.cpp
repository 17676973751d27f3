// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/tree_reference.hpp"

#include "anholon/free_dynamics.hpp"

namespace anholon {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// M = L^T D L by dense elimination from the last row.
template <class S>
struct DenseFactor {
  Matrix<S> L;
  std::vector<S> D;

  explicit DenseFactor(Matrix<S> M) : L(M.rows(), M.rows()), D(at(M.rows()), S(0)) {
    for (int k = M.rows(); k-- > 0;) {
      D[at(k)] = M(k, k);
      L(k, k) = S(1);
      for (int i = 0; i < k; ++i) L(k, i) = M(k, i) / M(k, k);
      for (int i = 0; i < k; ++i) {
        for (int j = 0; j < k; ++j) M(i, j) = M(i, j) - L(k, i) * D[at(k)] * L(k, j);
      }
    }
  }
  [[nodiscard]] std::vector<S> solve(std::vector<S> x) const {
    const int n = L.rows();
    for (int k = n; k-- > 0;) {
      for (int i = 0; i < k; ++i) x[at(i)] = x[at(i)] - L(k, i) * x[at(k)];
    }
    for (int k = 0; k < n; ++k) {
      x[at(k)] = x[at(k)] / D[at(k)];
      for (int i = 0; i < k; ++i) x[at(k)] = x[at(k)] - L(k, i) * x[at(i)];
    }
    return x;
  }
};

template <class S>
class Reference {
 public:
  Reference(const Mechanism<S>& mechanism, const TreePoint<S>& point)
      : mechanism_(mechanism),
        point_(point),
        dynamics_(mechanism),
        n_(static_cast<int>(free_components(mechanism.group).size())) {}

  NamedValues<S> operator()(const std::string& name) {
    if (name == "inverse_dynamics") return forces(dynamics_.inverse_dynamics(point_.state, acceleration()));
    if (name == "bias_forces") return forces(dynamics_.inverse_dynamics(point_.state, zero()));
    if (name == "gravity_forces") {
      const Mechanism<S> bare = without_own_forces();
      return forces(FreeDynamics<S>(bare).inverse_dynamics(at_rest(), zero()));
    }
    if (name == "mass_matrix") return {{"M", mass_matrix().entries()}};
    if (name == "forward_dynamics") return forward_dynamics();
    if (name == "imposed_motion") return imposed_motion();
    if (name == "mass_factor") {
      const DenseFactor<S> factor(mass_matrix());
      return {{"L", factor.L.entries()}, {"D", factor.D}};
    }
    if (name == "inverse_mass_matrix") return {{"M_inverse", inverse_mass_matrix()}};
    if (name == "centroidal_momentum") return centroidal_momentum();
    if (name == "energies") {
      const auto e = dynamics_.energies(point_.state);
      return {{"kinetic", {e.kinetic}},
              {"gravity", {e.gravity}},
              {"elastic", {e.elastic}},
              {"dissipated_power", {e.dissipated_power}}};
    }
    if (name == "forward_kinematics") return forward_kinematics();
    if (name == "jacobians") return jacobians();
    if (name == "regressor") return {{"Y", regressor().entries()}};
    throw std::logic_error("no reference for the function " + name);
  }

 private:
  [[nodiscard]] std::vector<S> zero() const { return std::vector<S>(at(n_ + mechanism_.coordinates), S(0)); }
  [[nodiscard]] std::vector<S> acceleration() const {
    std::vector<S> a;
    for (const int c : free_components(mechanism_.group)) a.push_back(point_.eta_dot[c]);
    a.insert(a.end(), point_.r_ddot.begin(), point_.r_ddot.end());
    return a;
  }
  [[nodiscard]] State<S> at_rest() const {
    State<S> rest = point_.state;
    rest.eta = {};
    for (S& rate : rest.r_dot) rate = S(0);
    return rest;
  }
  [[nodiscard]] Mechanism<S> without_own_forces() const {
    Mechanism<S> bare = mechanism_;
    bare.generalised_forces = {};
    return bare;
  }
  Matrix<S> mass_matrix() { return dynamics_.mass_matrix(point_.state); }

  /// A vector over (eta, r) as two blocks.
  NamedValues<S> split(const std::vector<S>& v, const std::string& base, const std::string& joints) const {
    NamedValues<S> blocks;
    blocks[base].assign(v.begin(), v.begin() + n_);
    blocks[joints].assign(v.begin() + n_, v.end());
    return blocks;
  }
  NamedValues<S> forces(const std::vector<S>& v) const { return split(v, "base_wrench", "tau"); }

  NamedValues<S> forward_dynamics() {
    std::vector<S> b = dynamics_.forces(point_.state);
    for (std::size_t i = 0; i < point_.tau.size(); ++i) b[at(n_) + i] = b[at(n_) + i] + point_.tau[i];
    return split(DenseFactor<S>(mass_matrix()).solve(b), "eta_dot", "r_ddot");
  }

  /// The base accelerates so that no wrench acts on it.
  NamedValues<S> imposed_motion() {
    std::vector<S> v_dot = acceleration();
    std::fill(v_dot.begin(), v_dot.begin() + n_, S(0));
    std::vector<S> b = dynamics_.inverse_dynamics(point_.state, v_dot);
    const Matrix<S> M = mass_matrix();
    Matrix<S> base(n_, n_);
    for (int i = 0; i < n_; ++i) {
      for (int j = 0; j < n_; ++j) base(i, j) = M(i, j);
    }
    b.resize(at(n_));
    for (S& x : b) x = -x;
    const std::vector<S> eta_dot = DenseFactor<S>(base).solve(b);
    std::copy(eta_dot.begin(), eta_dot.end(), v_dot.begin());
    NamedValues<S> blocks = forces(dynamics_.inverse_dynamics(point_.state, v_dot));
    blocks.erase("base_wrench");
    blocks["eta_dot"] = eta_dot;
    return blocks;
  }

  std::vector<S> inverse_mass_matrix() {
    const DenseFactor<S> factor(mass_matrix());
    const int size = factor.L.rows();
    Matrix<S> inverse(size, size);
    for (int c = 0; c < size; ++c) {
      std::vector<S> e = zero();
      e[at(c)] = S(1);
      const std::vector<S> column = factor.solve(e);
      for (int i = 0; i < size; ++i) inverse(i, c) = column[at(i)];
    }
    return inverse.entries();
  }

  /// Sums over the bodies.
  NamedValues<S> centroidal_momentum() {
    Recursion<S> recursion(mechanism_);
    recursion.position(point_.state);
    recursion.twists(point_.state);
    std::vector<Mat3<S>> R;
    std::vector<Vec3<S>> p;
    recursion.poses(point_.state, R, p);
    Vec3<S> P, H, moment;
    S mass = S(0);
    for (std::size_t k = 0; k < R.size(); ++k) {
      const Body<S>& b = mechanism_.bodies[k];
      const auto& m = recursion.motion(static_cast<int>(k));
      const Vec3<S> linear = R[k] * (b.mass * m.v + cross(m.w, b.first_moment));
      P += linear;
      H += R[k] * (cross(b.first_moment, m.v) + b.inertia * m.w) + cross(p[k], linear);
      moment += b.mass * p[k] + R[k] * b.first_moment;
      mass = mass + b.mass;
    }
    const Vec3<S> centre = (S(1) / mass) * moment;
    H -= cross(centre, P);
    return {{"momentum", {P.x, P.y, P.z, H.x, H.y, H.z}}, {"centre", {centre.x, centre.y, centre.z}}};
  }

  NamedValues<S> forward_kinematics() {
    std::vector<Mat3<S>> R;
    std::vector<Vec3<S>> p;
    dynamics_.poses(point_.state, R, p);
    NamedValues<S> blocks;
    for (std::size_t k = 0; k < R.size(); ++k) {
      const std::string& name = mechanism_.bodies[k].name;
      blocks["R_" + name].assign(R[k].m.begin(), R[k].m.end());
      blocks["p_" + name] = {p[k].x, p[k].y, p[k].z};
    }
    return blocks;
  }

  /// Twist of a body's described frame, in its own axes.
  static std::vector<S> in_frame(const Body<S>& body, const Vec3<S>& linear, const Vec3<S>& angular) {
    const Vec3<S> v = transposed_times(body.R_frame, linear), w = transposed_times(body.R_frame, angular);
    return {v.x, v.y, v.z, w.x, w.y, w.z};
  }

  NamedValues<S> jacobians() {
    Recursion<S> recursion(mechanism_);
    recursion.position(point_.state);
    const int size = n_ + mechanism_.coordinates;
    NamedValues<S> blocks;
    const auto for_each_tip = [&](const auto& visit) {
      for (std::size_t k = 0; k < mechanism_.bodies.size(); ++k) {
        bool is_parent = false;
        for (const Body<S>& b : mechanism_.bodies) is_parent = is_parent || b.parent == static_cast<int>(k);
        if (!is_parent) visit(mechanism_.bodies[k], recursion.motion(static_cast<int>(k)));
      }
    };
    for (int c = 0; c < size; ++c) {
      std::vector<S> e = zero();
      e[at(c)] = S(1);
      State<S> moving = point_.state;
      scatter(mechanism_, std::span<const S>(e), moving.eta, moving.r_dot);
      recursion.twists(moving);
      for_each_tip([&](const Body<S>& body, const auto& m) {
        std::vector<S>& J = blocks["J_" + body.name];
        J.resize(at(6 * size), S(0));
        const std::vector<S> column = in_frame(body, m.v, m.w);
        for (int i = 0; i < 6; ++i) J[at(i * size + c)] = column[at(i)];
      });
    }
    recursion.twists(point_.state);
    recursion.accelerations(point_.state, Spatial<S>{}, recursion.no_acceleration(), false);
    for_each_tip([&](const Body<S>& body, const auto& m) {
      blocks["bias_" + body.name] = in_frame(body, m.a - cross(m.w, m.v), m.wd);
    });
    return blocks;
  }

  /// One inverse dynamics for each figure: that figure is one, all others are zero.
  Matrix<S> regressor() {
    Mechanism<S> bare = without_own_forces();
    std::vector<std::size_t> moving;
    for (std::size_t k = 0; k < bare.bodies.size(); ++k) {
      Body<S>& b = bare.bodies[k];
      b.mass = b.armature = S(0), b.first_moment = {}, b.inertia = {};
      if (k == 0 || b.kind != JointKind::fixed) moving.push_back(k);
    }
    constexpr int entries[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    Matrix<S> Y(n_ + bare.coordinates, 10 * static_cast<int>(moving.size()));
    for (std::size_t i = 0; i < moving.size(); ++i) {
      Body<S>& b = bare.bodies[moving[i]];
      for (int figure = 0; figure < 10; ++figure) {
        if (figure == 0) b.mass = S(1);
        if (figure >= 1 && figure < 4) b.first_moment = b.R_frame * unit<S>(figure - 1);
        if (figure >= 4) {
          Mat3<S> I;
          I(entries[figure - 4][0], entries[figure - 4][1]) = S(1);
          I(entries[figure - 4][1], entries[figure - 4][0]) = S(1);
          b.inertia = b.R_frame * I * b.R_frame.transposed();
        }
        const std::vector<S> column = FreeDynamics<S>(bare).inverse_dynamics(point_.state, acceleration());
        for (int row = 0; row < Y.rows(); ++row) Y(row, 10 * static_cast<int>(i) + figure) = column[at(row)];
        b.mass = S(0), b.first_moment = {}, b.inertia = {};
      }
    }
    return Y;
  }

  const Mechanism<S>& mechanism_;
  const TreePoint<S>& point_;
  FreeDynamics<S> dynamics_;
  int n_;
};

}  // namespace

template <class S>
NamedValues<S> tree_inputs(const Mechanism<S>& mechanism, const TreePoint<S>& point) {
  const State<S>& s = point.state;
  NamedValues<S> in;
  in["R"] = {s.R.m.begin(), s.R.m.end()};
  in["p"] = {s.p.x, s.p.y, s.p.z};
  in["r"] = s.r, in["r_dot"] = s.r_dot, in["r_ddot"] = point.r_ddot, in["tau"] = point.tau;
  in["eta"], in["eta_dot"];
  for (const int c : free_components(mechanism.group)) {
    in["eta"].push_back(s.eta[c]);
    in["eta_dot"].push_back(point.eta_dot[c]);
  }
  return in;
}

template <class S>
NamedValues<S> tree_reference(const Mechanism<S>& mechanism, const std::string& function,
                              const TreePoint<S>& point) {
  return Reference<S>(mechanism, point)(function);
}

template NamedValues<double> tree_inputs(const Mechanism<double>&, const TreePoint<double>&);
template NamedValues<Exact> tree_inputs(const Mechanism<Exact>&, const TreePoint<Exact>&);
template NamedValues<double> tree_reference(const Mechanism<double>&, const std::string&,
                                            const TreePoint<double>&);
template NamedValues<Exact> tree_reference(const Mechanism<Exact>&, const std::string&,
                                           const TreePoint<Exact>&);

}  // namespace anholon
