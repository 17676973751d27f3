// SPDX-License-Identifier: GPL-2.0-or-later
//
// The article's own route to the free dynamics of robots whose compliant bodies are terminal: the inverse
// dynamics D_FMS^-1 with elastic accelerations as outputs, (64)-(65) and (69)-(72), called with the inputs of
// section V.B; then (29) from (30)-(36). With the errata: (69) and (79) bring inertia forces with the sign of
// the right-hand side, and the frame of a successor turns about the displaced point. Bodies are points of
// mass, beams are quadrature; nothing is shared with the recursion but the description.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "mechanics/beam_shapes.hpp"
#include "mechanics/witness.hpp"

namespace anholon::elastic_output_test {
namespace {

using namespace test;  // NOLINT: the vocabulary of these tests
using Dense = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Column = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using V3 = Eigen::Matrix<Real, 3, 1>;
using M3 = Eigen::Matrix<Real, 3, 3>;
using V6 = Eigen::Matrix<Real, 6, 1>;  // (V, Omega)
using M6 = Eigen::Matrix<Real, 6, 6>;

Dense solve(const Dense& m, const Dense& b) { return m.ldlt().solve(b); }

M3 hat(const V3& w) {
  M3 m;
  m << 0, -w(2), w(1), w(2), 0, -w(0), -w(1), w(0), 0;
  return m;
}

/// A mass with its displacements per modal coordinate, 3 x modes.
struct Particle {
  Real mass = 0;
  V3 at;
  Dense phi;
};

struct Link {
  std::string name;
  int parent = -1;
  V3 offset = V3::Zero(), axis = V3::UnitZ();  // of the joint, at zero displacement parallel to the parent
  bool hinged = false;
  std::vector<Particle> particles;
  Dense stiffness, damping;  // modes x modes
  [[nodiscard]] Eigen::Index modes() const { return stiffness.rows(); }
};

Link rigid(const std::string& name, int parent, const Cloud& cloud) {
  Link link;
  link.name = name, link.parent = parent;
  for (const auto& [m, x, y, z] : cloud) link.particles.push_back({m, V3(x, y, z), Dense::Zero(3, 0)});
  link.stiffness = link.damping = Dense::Zero(0, 0);
  return link;
}

/// Adds a uniform beam along x to a link; modes plane after plane.
void add_beam(Link& link, Real L, Real rhoA, Real EI, int modes, const std::string& planes, Real damping) {
  const auto n = static_cast<Eigen::Index>(planes.size()) * modes;
  std::vector<Cantilever> shapes;
  for (int j = 1; j <= modes; ++j) shapes.emplace_back(j);
  for (Particle& p : link.particles) p.phi = Dense::Zero(3, n);
  link.stiffness = Dense::Zero(n, n);
  link.damping = damping * Dense::Identity(n, n);
  for (const auto& [s, w] : gauss_legendre(40)) {  // exact for the products of these modes to 1e-19
    Particle p{rhoA * L * w, V3(L * s, 0, 0), Dense::Zero(3, n)};
    Eigen::Index next = 0;
    for (const char plane : planes) {
      for (int j = 0; j < modes; ++j) {
        p.phi(plane == 'y' ? 1 : 2, next + j) = shapes[static_cast<std::size_t>(j)].at(s);
        for (int l = 0; l < modes; ++l)
          link.stiffness(next + j, next + l) += EI * w / (L * L * L) *
                                                shapes[static_cast<std::size_t>(j)].curvature(s) *
                                                shapes[static_cast<std::size_t>(l)].curvature(s);
      }
      next += modes;
    }
    link.particles.push_back(p);
  }
}

/// The generalised Newton-Euler model (69) of one body.
struct NewtonEuler {
  M6 M = M6::Zero();
  V6 F = V6::Zero();  // inertia forces of the velocities and gravity, on the right-hand side
  Dense M_e, m;       // modes x 6, modes x modes
  Column Q;
};

NewtonEuler newton_euler(const Link& link, const M3& R, const V6& eta, const Column& r, const Column& r_dot,
                         const V3& gravity) {
  const Eigen::Index n = link.modes();
  NewtonEuler k;
  k.M_e = Dense::Zero(n, 6), k.m = Dense::Zero(n, n);
  k.Q = -(link.stiffness * r + link.damping * r_dot);
  const V3 V = eta.head(3), W = eta.tail(3);
  for (const Particle& point : link.particles) {
    const V3 p = point.at + point.phi * r, rate = point.phi * r_dot;
    Eigen::Matrix<Real, 3, 6> D;  // of the point's velocity by the twist
    D << M3::Identity(), -hat(p);
    const V3 bias = W.cross(V) + W.cross(W.cross(p)) + 2 * W.cross(rate) - R.transpose() * gravity;
    k.M += point.mass * D.transpose() * D;
    k.M_e += point.mass * point.phi.transpose() * D;
    k.m += point.mass * point.phi.transpose() * point.phi;
    k.F -= point.mass * D.transpose() * bias;
    k.Q -= point.mass * point.phi.transpose() * bias;
  }
  return k;
}

struct Motion {
  M3 R;  // of the reference body
  V6 eta;
  std::vector<Column> r_e, r_e_dot;  // by link
  Column r_j, r_j_dot;               // hinges in their order
};

/// Outputs of D_FMS^-1.
struct Outputs {
  V6 f_reac;
  Column r_e_ddot, tau;
};

class Tree {
 public:
  Tree(std::vector<Link> links, const V3& gravity) : links_(std::move(links)), gravity_(gravity) {
    for (const Link& link : links_) hinges_ += link.hinged ? 1 : 0, modes_ += link.modes();
  }
  [[nodiscard]] Eigen::Index hinges() const { return hinges_; }
  [[nodiscard]] Eigen::Index modes() const { return modes_; }

  /// Elastic accelerations are outputs. @param moving false: all velocities zero; gravity and springs act
  /// either way.
  [[nodiscard]] Outputs inverse_dynamics(const Motion& s, bool moving, const V6& eta_dot,
                                         const Column& r_j_ddot) const {
    const std::size_t count = links_.size();
    std::vector<M3> R(count);
    std::vector<M6> Ad(count, M6::Identity());
    std::vector<V6> A(count, V6::Zero()), eta(count), acceleration(count), wrench(count);
    R[0] = s.R;
    eta[0] = moving ? s.eta : V6::Zero();
    acceleration[0] = eta_dot;
    Eigen::Index hinge = 0;
    for (std::size_t k = 1; k < count; ++k) {  // (70)-(72)
      const Link& link = links_[k];
      const auto i = static_cast<std::size_t>(link.parent);
      M3 turn = M3::Identity();
      Real rate = 0, r_ddot = 0;
      if (link.hinged) {
        turn = Eigen::AngleAxis<Real>(s.r_j(hinge), link.axis).toRotationMatrix();
        rate = moving ? s.r_j_dot(hinge) : 0;
        r_ddot = r_j_ddot(hinge++);
        A[k].tail(3) = link.axis;
      }
      R[k] = R[i] * turn;
      Ad[k] << turn.transpose(), -turn.transpose() * hat(link.offset), M3::Zero(), turn.transpose();
      const V6 carried = Ad[k] * eta[i];
      eta[k] = carried + A[k] * rate;
      const V3 w = rate * link.axis;  // zeta holds the rate of Ad as well
      V6 zeta = A[k] * r_ddot;
      zeta.head(3) -= w.cross(V3(carried.head(3))), zeta.tail(3) -= w.cross(V3(carried.tail(3)));
      acceleration[k] = Ad[k] * acceleration[i] + zeta;
    }
    Outputs out{V6::Zero(), Column::Zero(modes_), Column::Zero(hinges_)};
    for (V6& f : wrench) f.setZero();
    Eigen::Index mode = modes_;
    for (std::size_t k = count; k-- > 0;) {
      const Link& link = links_[k];
      const Column rate = moving ? s.r_e_dot[k] : Column::Zero(link.modes());
      const NewtonEuler body = newton_euler(link, R[k], eta[k], s.r_e[k], rate, gravity_);
      if (link.modes() == 0) {
        wrench[k] += body.M * acceleration[k] - body.F;
      } else {  // terminal: (64), (65)
        mode -= link.modes();
        out.r_e_ddot.segment(mode, link.modes()) = solve(body.m, body.Q - body.M_e * acceleration[k]);
        wrench[k] += (body.M - body.M_e.transpose() * solve(body.m, body.M_e)) * acceleration[k] -
                     (body.F - body.M_e.transpose() * solve(body.m, body.Q));
      }
      if (link.hinged) out.tau(--hinge) = A[k].dot(wrench[k]);
      if (k > 0) wrench[static_cast<std::size_t>(link.parent)] += Ad[k].transpose() * wrench[k];
    }
    out.f_reac = wrench[0];
    return out;
  }

  /// (29), from (30)-(36): mass matrix and forces over (eta, r_e, r_j).
  [[nodiscard]] std::pair<Dense, Column> free_dynamics(const Motion& s) const {
    const Column none = Column::Zero(hinges_);
    const Outputs at_rest = inverse_dynamics(s, false, V6::Zero(), none),
                  moving = inverse_dynamics(s, true, V6::Zero(), none);
    const Eigen::Index inputs = 6 + hinges_;
    Dense M_tilde(inputs, inputs);  // (32)-(34)
    Dense elastic(modes_, inputs);  // -m_ee^-1 (M_e, m_je^T)
    for (Eigen::Index k = 0; k < inputs; ++k) {
      V6 eta_dot = V6::Zero();
      Column r_ddot = none;
      (k < 6 ? eta_dot(k) : r_ddot(k - 6)) = 1;
      const Outputs out = inverse_dynamics(s, false, eta_dot, r_ddot);
      M_tilde.col(k) << out.f_reac - at_rest.f_reac, out.tau - at_rest.tau;
      elastic.col(k) = out.r_e_ddot - at_rest.r_e_ddot;
    }
    Dense m_ee = Dense::Zero(modes_, modes_);  // diagonal by bodies, because they are terminal
    Eigen::Index next = 0;
    for (std::size_t k = 0; k < links_.size(); ++k) {
      const Eigen::Index n = links_[k].modes();
      m_ee.block(next, next, n, n) =
          newton_euler(links_[k], s.R, V6::Zero(), s.r_e[k], Column::Zero(n), gravity_).m;
      next += n;
    }
    const Dense M_e = -m_ee * elastic;  // modes x (eta, r_j)
    const Column Q_e = m_ee * moving.r_e_ddot;
    const Dense back = M_e.transpose() * solve(m_ee, M_e);
    const Dense outer = M_tilde + back;  // over (eta, r_j)
    Column f_tilde(inputs);
    f_tilde << -moving.f_reac, -moving.tau;
    const Column f = f_tilde + M_e.transpose() * solve(m_ee, Q_e);  // (35), (36)
    const Eigen::Index size = 6 + modes_ + hinges_;
    Dense M = Dense::Zero(size, size);
    Column force(size);
    M.block(0, 0, 6, 6) = outer.topLeftCorner(6, 6);
    M.block(6, 6, modes_, modes_) = m_ee;
    M.block(6, 0, modes_, 6) = M_e.leftCols(6), M.block(0, 6, 6, modes_) = M_e.leftCols(6).transpose();
    const Eigen::Index j = 6 + modes_;
    M.block(j, j, hinges_, hinges_) = outer.bottomRightCorner(hinges_, hinges_);
    M.block(j, 0, hinges_, 6) = outer.bottomLeftCorner(hinges_, 6);
    M.block(0, j, 6, hinges_) = outer.topRightCorner(6, hinges_);
    M.block(j, 6, hinges_, modes_) = M_e.rightCols(hinges_).transpose();
    M.block(6, j, modes_, hinges_) = M_e.rightCols(hinges_);
    force << f.head(6), Q_e, f.tail(hinges_);
    return {M, force};
  }

 private:
  std::vector<Link> links_;
  V3 gravity_;
  Eigen::Index hinges_ = 0, modes_ = 0;
};

// base -- arm -- tail, a beam in both planes on a hinge, with a rigid root of its own;  base -- panel, a
// fixed beam
TEST(ElasticAccelerationsAsOutputs, GiveTheFreeDynamicsOfTerminalBeams) {
  const std::string text =
      header("SE3", "gravity = [0.6, -3.1, -8.8]") + body("base", "", cloud(0)) +
      body("arm", "base", cloud(1),
           "pose = { translation = [0.2, -0.1, 0.3] }\n"
           "joint = { kind = \"revolute\", axis = [0, -0.28, 0.96], coordinate = \"a\" }\n") +
      body("tail", "arm", cloud(2),
           "pose = { translation = [0.15, 0.05, -0.1] }\n"
           "joint = { kind = \"revolute\", axis = [0.6, 0, 0.8], coordinate = \"b\" }\n"
           "[body.beam]\nlength = 0.8\nmass_per_length = 0.9\nbending_stiffness = 1.4\nmodes = 2\n"
           "planes = [\"y\", \"z\"]\ndeformation = \"quadratic\"\nmodal_damping = 0.2\nrange = [-0.4, "
           "0.4]\n") +
      body("panel", "base", {},
           "pose = { translation = [-0.2, 0.1, 0] }\njoint = { kind = \"fixed\" }\n"
           "[body.beam]\nlength = 0.6\nmass_per_length = 0.5\nbending_stiffness = 0.7\nmodes = 3\n"
           "deformation = \"quadratic\"\nrange = [-0.4, 0.4]\n");
  const Model model = read_model_text(text, "terminal.toml");
  ASSERT_EQ(model.coordinates.size(), 9U);  // a, b, four modes, three modes
  const Mechanism<Real> mechanism = mechanise<Real>(describe_mechanism(model), {});
  FreeDynamics<Real> dynamics(mechanism);

  std::vector<Link> links = {rigid("base", -1, cloud(0)), rigid("arm", 0, cloud(1)),
                             rigid("tail", 1, cloud(2)), rigid("panel", 0, {})};
  links[1].offset = V3(0.2L, -0.1L, 0.3L), links[1].axis = V3(0, -0.28L, 0.96L), links[1].hinged = true;
  links[2].offset = V3(0.15L, 0.05L, -0.1L), links[2].axis = V3(0.6L, 0, 0.8L), links[2].hinged = true;
  links[3].offset = V3(-0.2L, 0.1L, 0);
  add_beam(links[2], 0.8L, 0.9L, 1.4L, 2, "yz", 0.2L);
  add_beam(links[3], 0.6L, 0.5L, 0.7L, 3, "y", 0);
  const Tree tree(links, V3(0.6L, -3.1L, -8.8L));

  // Places of (eta, r_e, r_j) among (eta, coordinates in declared order).
  std::vector<std::size_t> place = {0, 1, 2, 3, 4, 5};
  for (const char* name :
       {"tail_e1", "tail_e2", "tail_e3", "tail_e4", "panel_e1", "panel_e2", "panel_e3", "a", "b"}) {
    for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
      if (model.coordinates[i].name == name) place.push_back(6 + i);
    }
  }
  ASSERT_EQ(place.size(), 15U);

  std::mt19937_64 rng(2013);
  BlockErrors errors;
  for (int sample = 0; sample < 20; ++sample) {
    State<Real> s = random_position_and_velocity(model, rng);  // deflections to 0.5 m, rates to 2 a second
    Motion m;
    for (int i = 0; i < 9; ++i) m.R(i / 3, i % 3) = s.R.m[static_cast<std::size_t>(i)];
    for (int i = 0; i < 6; ++i) m.eta(i) = s.eta[i];
    const auto of = [&](std::size_t first, Eigen::Index count, const std::vector<Real>& from) {
      Column c(count);
      for (Eigen::Index i = 0; i < count; ++i) c(i) = from[place[first + static_cast<std::size_t>(i)] - 6];
      return c;
    };
    m.r_e = {Column::Zero(0), Column::Zero(0), of(6, 4, s.r), of(10, 3, s.r)};
    m.r_e_dot = {Column::Zero(0), Column::Zero(0), of(6, 4, s.r_dot), of(10, 3, s.r_dot)};
    m.r_j = of(13, 2, s.r), m.r_j_dot = of(13, 2, s.r_dot);
    const auto [M, force] = tree.free_dynamics(m);
    std::vector<std::vector<Real>> want_M(15, std::vector<Real>(15));
    std::vector<Real> want(15);
    for (std::size_t i = 0; i < 15; ++i) {
      want[place[i]] = force(static_cast<Eigen::Index>(i));
      for (std::size_t j = 0; j < 15; ++j)
        want_M[place[i]][place[j]] = M(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
    add_dynamics(errors, "recursion", 6, want_M, want, dynamics.mass_matrix(s), dynamics.forces(s));
  }
  // Long double, 5.4e-20 an operation. The route takes columns from differences to the call at rest, whose
  // elastic accelerations are up to 2e4 m/s^2 here, and multiplies with these again for f: 5e-20 (2e4)^2
  // times a modal mass of 0.08 kg, over forces of 60 N, is 3e-14.
  for (const char* block : {"recursion M_eta_eta", "recursion M_r_eta", "recursion m_rr", "recursion Q"})
    EXPECT_LT(errors.worst(block), 1e-15L) << block;
  EXPECT_LT(errors.worst("recursion f"), 1e-12L);
}

}  // namespace
}  // namespace anholon::elastic_output_test
