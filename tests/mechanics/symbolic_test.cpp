// SPDX-License-Identifier: GPL-2.0-or-later
//
// The recursion and the projection run over GiNaC's expressions on small systems, against the tape's
// programs: every difference is zero as a rational function of the symbols with c^2 + s^2 = 1.
#include <gtest/gtest.h>

#include "anholon/free_dynamics.hpp"
#include "mechanics/symbolic_model.hpp"

namespace anholon::symbolic_test {
namespace {

using test::ex;
using test::Expressions;

/// A waist about Z and two parallel joints about Y, with point masses on the links.
Model three_joint_arm() {
  return read_model_text(R"toml(
anholon = 1
name = "arm3"
group = "fixed"
gravity = [0, 0, "-gamma"]
[parameters]
gamma = { value = 9.81, unit = "m/s^2" }
m = { value = 1.5, unit = "kg" }
J = { value = 0.02, unit = "kg m^2" }
l = { value = 0.4, unit = "m" }
[[body]]
name = "base"
[[body]]
name = "waist"
parent = "base"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "r1", drive = "active" }
inertia = { about_com = { zz = "J" } }
[[body]]
name = "upper"
parent = "waist"
joint = { kind = "revolute", axis = [0, 1, 0], coordinate = "r2", drive = "active" }
inertia = { mass = "m", com = ["l/2", 0, 0] }
[[body]]
name = "lower"
parent = "upper"
pose = { translation = ["l", 0, 0] }
joint = { kind = "revolute", axis = [0, 1, 0], coordinate = "r3", drive = "active" }
inertia = { mass = "m", com = ["l", 0, 0] }
)toml",
                         "arm3.toml");
}

struct Case {
  const char* name;
  Model (*model)();
};
void PrintTo(const Case& c, std::ostream* stream) { *stream << c.name; }

class Ginac : public testing::TestWithParam<Case> {};

std::vector<int> range(int from, int to) {
  std::vector<int> r;
  for (int i = from; i < to; ++i) r.push_back(i);
  return r;
}

TEST_P(Ginac, DerivesTheFreeDynamicsOfTheTape) {
  test::SymbolicModel s(GetParam().model());
  const Partition& p = s.partition();
  Expressions passive = s.input("eta");
  for (const ex& rate : s.input("r_p_dot")) passive.push_back(rate);
  const State<ex> state = s.state(passive);
  FreeDynamics<ex> dynamics(s.mechanism());
  const Matrix<ex> M = dynamics.mass_matrix(state);
  const Expressions force = dynamics.forces(state);
  const std::vector<int> eta = range(0, p.n);
  const std::vector<int> r_p(p.passive.begin() + p.n, p.passive.end());
  struct Block {
    const char* name;
    std::vector<int> rows, cols;
  };
  int entries = 0;
  for (const Block& b :
       {Block{"M_eta_eta", eta, eta}, Block{"M_p", r_p, eta}, Block{"M_a", p.active, eta},
        Block{"m_pp", r_p, r_p}, Block{"m_pa", r_p, p.active}, Block{"m_aa", p.active, p.active}}) {
    const Matrix<ex> have = s.output("free_dynamics", b.name);
    if (b.rows.empty() || b.cols.empty()) continue;
    ASSERT_EQ(have.rows(), static_cast<int>(b.rows.size())) << b.name;
    for (int i = 0; i < have.rows(); ++i) {
      for (int j = 0; j < have.cols(); ++j, ++entries)
        EXPECT_TRUE(s.vanishes(have(i, j) - M.block(b.rows, b.cols)(i, j))) << b.name << ' ' << i << ' ' << j;
    }
  }
  for (const auto& [name, rows] : {std::pair("f", eta), std::pair("Q_p", r_p), std::pair("Q_a", p.active)}) {
    const Matrix<ex> have = s.output("free_dynamics", name);
    for (int i = 0; i < have.rows(); ++i, ++entries)
      EXPECT_TRUE(s.vanishes(have(i, 0) - force[static_cast<std::size_t>(rows[static_cast<std::size_t>(i)])]))
          << name << ' ' << i;
  }
  EXPECT_GT(entries, 3);
}

// (66)-(68) and (27), with J_dot r_a_dot + H_dot nu differentiated by GiNaC.
TEST_P(Ginac, ProjectsAsTheTapeDoes) {
  test::SymbolicModel s(GetParam().model());
  const Partition& p = s.partition();
  const Expressions nu = s.input("nu"), r_a_dot = s.input("r_a_dot"), r_a_ddot = s.input("r_a_ddot");
  Matrix<ex> H(static_cast<int>(p.passive.size()), static_cast<int>(nu.size())), J(H.rows(), p.s_a());
  if (H.cols() > 0) H = s.output("kinematics", "H");
  if (H.rows() > 0) J = s.output("kinematics", "J");
  Expressions passive = J * r_a_dot;
  const Expressions reduced = H * nu;
  for (std::size_t i = 0; i < passive.size(); ++i) passive[i] += reduced[i];
  const State<ex> state = s.state(passive);

  Expressions drift(passive.size(), ex(0));  // these kernels depend on r alone
  const Expressions r_p = s.input("r_p"), r_a = s.input("r_a");
  for (std::size_t i = 0; i < drift.size(); ++i) {
    for (std::size_t k = 0; k < r_p.size(); ++k)
      drift[i] +=
          passive[i].diff(GiNaC::ex_to<GiNaC::symbol>(r_p[k])) * passive[static_cast<std::size_t>(p.n) + k];
    for (std::size_t k = 0; k < r_a.size(); ++k)
      drift[i] += passive[i].diff(GiNaC::ex_to<GiNaC::symbol>(r_a[k])) * r_a_dot[k];
  }
  FreeDynamics<ex> dynamics(s.mechanism());
  const Matrix<ex> M = dynamics.mass_matrix(state);
  const Expressions force = dynamics.forces(state);
  const Matrix<ex> M_pp = M.block(p.passive, p.passive), M_pa = M.block(p.passive, p.active),
                   M_aa = M.block(p.active, p.active);
  const Expressions imposed = J * r_a_ddot;
  Expressions at_rest = drift;  // accelerations with nu_dot = 0
  for (std::size_t i = 0; i < at_rest.size(); ++i) at_rest[i] += imposed[i];
  const auto residual = [&](const Expressions& v_p_dot) {  // M v_dot - f on the passive rows
    Expressions sum = M_pp * v_p_dot;
    const Expressions driven = M_pa * r_a_ddot;
    for (std::size_t i = 0; i < sum.size(); ++i)
      sum[i] += driven[i] - force[static_cast<std::size_t>(p.passive[i])];
    return sum;
  };
  const Matrix<ex> Ht = H.transposed();
  const Matrix<ex> M_r = Ht * (M_pp * H);
  const Expressions f_r = Ht * residual(at_rest);
  if (H.cols() > 0) {
    const Matrix<ex> have_M = s.output("reduced_dynamics", "M_r"),
                     have_f = s.output("reduced_dynamics", "f_r");
    for (int i = 0; i < H.cols(); ++i) {
      EXPECT_TRUE(s.vanishes(have_f(i, 0) + f_r[static_cast<std::size_t>(i)])) << "f_r " << i;
      for (int j = 0; j < H.cols(); ++j)
        EXPECT_TRUE(s.vanishes(have_M(i, j) - M_r(i, j))) << "M_r " << i << ' ' << j;
    }
  }

  Expressions v_p_dot = at_rest;
  const Expressions driven = H * s.input("nu_dot");
  for (std::size_t i = 0; i < v_p_dot.size(); ++i) v_p_dot[i] += driven[i];
  const Expressions carried = J.transposed() * residual(v_p_dot);
  const Expressions own = M_pa.transposed() * v_p_dot, accelerated = M_aa * r_a_ddot;
  Expressions loading(p.active.size(), ex(0));
  if (const Expressions lambda_stat = s.input("lambda_stat"); !lambda_stat.empty())
    loading = s.output("constraints", "B_a").transposed() *
              (s.output("constraints", "lambda_stat_basis") * lambda_stat);
  const Matrix<ex> tau = s.output("inverse_torques", "tau_a");
  ASSERT_EQ(tau.rows(), p.s_a());
  for (std::size_t i = 0; i < p.active.size(); ++i) {
    const ex want =
        own[i] + accelerated[i] - force[static_cast<std::size_t>(p.active[i])] + carried[i] - loading[i];
    EXPECT_TRUE(s.vanishes(tau(static_cast<int>(i), 0) - want)) << "tau_a " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Small, Ginac,
    testing::Values(Case{"MobilePendulum", [] { return test::shipped_model("mobile_pendulum"); }},
                    Case{"RigidSnakeboard", [] { return test::shipped_model("rigid_snakeboard"); }},
                    Case{"ThreeJointArm", three_joint_arm}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace anholon::symbolic_test
