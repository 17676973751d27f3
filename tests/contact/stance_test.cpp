// SPDX-License-Identifier: GPL-2.0-or-later
//
// Feet on the ground: Newton's law for the whole system gives the sum of the contact forces; hyperstatic
// shares change with lambda_stat and leave the motion alone.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "anholon/free_dynamics.hpp"
#include "check/evaluate_program.hpp"
#include "derive/derive.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "reduce/samples.hpp"

namespace anholon::test {
namespace {

using Values = std::vector<Exact>;

/// A hull of 3 kg on legs of 0.5 kg, with a foot at each place; knees are driven.
Model stool_model(const std::vector<std::array<std::string, 2>>& feet, const std::string& contact) {
  std::string text = R"(anholon = 1
name = "stool"
group = "SE3"
gravity = [0, 0, -9.81]
[[body]]
name = "hull"
inertia = { mass = 3, com = [0.02, 0.01, 0.1], about_com = { xx = 0.2, yy = 0.3, zz = 0.4 } }
)";
  for (std::size_t i = 0; i < feet.size(); ++i)
    text += fmt::format(
        "[[body]]\nname = \"leg_{0}\"\nparent = \"hull\"\npose = {{ translation = [{1}, {2}, 0] }}\n"
        "joint = {{ kind = \"revolute\", axis = [{3}], coordinate = \"r{0}\", drive = \"active\", range = "
        "[-1, 1] }}\n"
        "inertia = {{ mass = 0.5, com = [0, 0.01, -0.2], about_com = {{ xx = 0.01, yy = 0.012, zz = 0.003 }} "
        "}}\n"
        "[[constraint]]\nname = \"foot_{0}\"\nkind = \"{4}\"\nbody = \"leg_{0}\"\npoint = [0.02, 0, -0.4]\n",
        i + 1, feet[i][0], feet[i][1], i % 2 == 0 ? "1, 0, 0" : "0, 1, 0", contact);
  return read_model_text(text, "stool.toml");
}

struct Stool {
  explicit Stool(Model described) : model(std::move(described)), partition(partition_of(model)) {
    DeriveRequest request;
    request.closed_forms = false;
    derivation = derive(model, request);
    call = interpreting_caller<Exact>(derivation->program, {});
    mechanism = mechanise<Exact>(describe_mechanism(model), {});
  }
  /// World axes: the sum of the contact forces minus the rate of the momentum and plus the weight.
  [[nodiscard]] Vec3<Exact> unbalanced(const State<Exact>& state, const Evaluated<Exact>& e) const {
    FreeDynamics<Exact> dynamics(mechanism);
    const auto momentum = [&](const Exact& h) {
      State<Exact> s = state;
      s.R = state.R + h * (state.R * skew(state.eta.angular));
      for (int c = 0; c < 6; ++c) s.eta[c] += h * e.acceleration[static_cast<std::size_t>(c)];
      for (std::size_t i = 0; i < s.r.size(); ++i) {
        s.r[i] += h * s.r_dot[i];
        s.r_dot[i] += h * e.acceleration[6 + i];
      }
      Values v;
      for (int c = 0; c < 6; ++c) v.push_back(s.eta[c]);
      v.insert(v.end(), s.r_dot.begin(), s.r_dot.end());
      const Values p = dynamics.mass_times(s, v);
      return s.R * Vec3<Exact>{p[0], p[1], p[2]};
    };
    const Exact h = Exact::from_decimal("1e-18");
    Vec3<Exact> sum = (Exact(-1) / (h + h)) * (momentum(h) - momentum(-h));
    std::vector<Mat3<Exact>> R;
    std::vector<Vec3<Exact>> p;
    dynamics.poses(state, R, p);
    Exact mass = 0;
    for (const auto& body : mechanism.bodies) mass += body.mass;
    sum += mass * mechanism.gravity;
    for (std::size_t i = 0; i < model.rows.size(); ++i) {  // rows x, y, z of each foot, in the leg's axes
      const std::string& name = model.rows[i].name;
      const int axis = name.back() - 'x';
      if (name.find("turn") != std::string::npos || axis < 0 || axis > 2) continue;
      const auto leg = static_cast<std::size_t>(name[5] - '0');
      sum += R[leg] * (e.lambda[i] * unit<Exact>(axis));
    }
    return sum;
  }

  Model model;
  Partition partition;
  std::unique_ptr<Derivation> derivation;
  ProgramCaller<Exact> call;
  Mechanism<Exact> mechanism;
};

double largest(const Values& v) {
  double size = 0;
  for (const Exact& x : v) size = std::max(size, abs(x).to_double());
  return size;
}

TEST(Stance, OnOneFootTheContactForceCarriesTheWeightAndTheChangeOfMomentum) {
  const WorkingDigits digits(60);
  for (const std::string contact : {"point", "surface"}) {
    SCOPED_TRACE(contact);
    const Stool stool(stool_model({{"0.1", "0.2"}}, contact));
    SampleSource source;
    for (int sample = 0; sample < 5; ++sample) {
      EvaluationInput<Exact> input;
      input.state = random_state(stool.model, source);
      NamedValues<Exact> in = position_inputs(stool.model, stool.partition, input.state);
      in["r_a_dot"] = {Exact::from_decimal("0.7")};
      for (int k = 0; k < stool.derivation->reduction.kernel.H.cols(); ++k)
        in["nu"].push_back(source.uniform(Exact(-1), Exact(1)));
      const auto v = stool.call("kinematics", in);
      for (int c = 0; c < 6; ++c) input.state.eta[c] = v.at("eta")[static_cast<std::size_t>(c)];
      input.state.r_dot = in["r_a_dot"];
      input.r_ddot = {Exact::from_decimal("-1.3")};
      input.has_acceleration = true;
      const auto e = evaluate_program(stool.model, *stool.derivation, stool.call, input);
      const Vec3<Exact> rest = stool.unbalanced(input.state, e);
      // the orientation is orthogonal to 1e-16 only, by which force and momentum are turned alike
      for (int i = 0; i < 3; ++i) EXPECT_LT(abs(rest[i]).to_double(), 1e-12);
    }
  }
}

TEST(Stance, OnThreeFeetLambdaStatSharesTheLoadAndLeavesTheSumAlone) {
  const WorkingDigits digits(60);
  const Stool stool(stool_model({{"0.3", "0"}, {"-0.2", "0.25"}, {"-0.2", "-0.25"}}, "point"));
  EXPECT_EQ(stool.derivation->reduction.ranks.m_locked, 6);
  EXPECT_EQ(stool.derivation->reduction.kernel.H.cols(), 0);
  SampleSource source;
  EvaluationInput<Exact> input;
  input.state = random_state(stool.model, source);
  NamedValues<Exact> in =
      position_inputs(stool.model, stool.partition, input.state);  // at rest, held by its motors
  in["r_a_dot"] = in["r_a_ddot"] = Values(3, Exact(0));
  input.state.eta = {};
  input.state.r_dot = input.r_ddot = Values(3, Exact(0));
  input.has_acceleration = true;
  const auto e = evaluate_program(stool.model, *stool.derivation, stool.call, input);
  EXPECT_LT(largest(e.acceleration), 1e-40);
  for (int i = 0; i < 3; ++i) EXPECT_LT(abs(stool.unbalanced(input.state, e)[i]).to_double(), 1e-12);

  in["lambda_stat"] = {Exact(1), Exact(-2), Exact::from_decimal("0.5")};
  Evaluated<Exact> shared = e;
  shared.lambda = stool.call("multipliers", in).at("lambda");
  Exact change = 0;
  for (std::size_t i = 0; i < e.lambda.size(); ++i)
    change = std::max(change, abs(shared.lambda[i] - e.lambda[i]));
  EXPECT_GT(change.to_double(), 0.5);
  for (int i = 0; i < 3; ++i) EXPECT_LT(abs(stool.unbalanced(input.state, shared)[i]).to_double(), 1e-12);
  const Values held = stool.call("inverse_torques", in).at("tau_a");  // the knees feel the share
  Exact torque_change = 0;
  for (std::size_t i = 0; i < held.size(); ++i)
    torque_change = std::max(torque_change, abs(held[i] - e.tau_a[i]));
  EXPECT_GT(torque_change.to_double(), 0.01);
}

// Three feet nearly in a line, by 1e-2 to 1e-6 m: the twist from given knee rates loses no more than the
// condition number of the rows, 50-digit evaluation as reference.
TEST(Stance, OnNearlyCollinearFeetKeepsTheDigitsThatTheConditionLeaves) {
  for (const char* offset : {"1e-2", "1e-6"}) {
    SCOPED_TRACE(offset);
    const Stool stool(stool_model({{"0.3", "0"}, {"0", offset}, {"-0.3", "0"}}, "point"));
    const auto in_double = interpreting_caller<double>(stool.derivation->program, {});
    SampleSource source;
    State<Exact> state = random_state(stool.model, source);
    state.r = {Exact(0), Exact(0), Exact(0)};
    NamedValues<Exact> in = position_inputs(stool.model, stool.partition, state);
    in["r_a_dot"] = {Exact(1), Exact(0), Exact(-1)};
    NamedValues<double> rounded;
    for (const auto& [name, values] : in) {
      for (const Exact& x : values) rounded[name].push_back(x.to_double());
    }
    const Values exact = stool.call("kinematics", in).at("eta");
    const std::vector<double> eta = in_double("kinematics", rounded).at("eta");
    const Values A = stool.call("constraints", in).at("A");
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(A.size()) / 6, 6);
    for (Eigen::Index i = 0; i < rows.size(); ++i)
      rows(i / 6, i % 6) = A[static_cast<std::size_t>(i)].to_double();
    const Eigen::VectorXd s = Eigen::JacobiSVD<Eigen::MatrixXd>(rows).singularValues();
    const double condition = s(0) / s(5);
    double error = 0;
    for (std::size_t i = 0; i < 6; ++i)
      error = std::max(error, abs(Exact::from_double(eta[i]) - exact[i]).to_double());
    fmt::print("offset {} m: condition {:.1e}, relative error {:.1e}\n", offset, condition,
               error / largest(exact));
    EXPECT_LT(error / largest(exact), 10 * 2.2e-16 * condition);
  }
}

}  // namespace
}  // namespace anholon::test
