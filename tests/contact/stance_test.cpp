// SPDX-License-Identifier: GPL-2.0-or-later
//
// Feet on the ground: Newton's law for the whole system gives the sum of the contact forces; hyperstatic
// shares change with lambda_stat and leave the motion alone.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>

#include "check/evaluate_program.hpp"
#include "contact/newtons_law.hpp"
#include "derive/derive.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "describe/scene.hpp"
#include "describe/specialise.hpp"
#include "reduce/decompositions.hpp"
#include "reduce/samples.hpp"

namespace anholon::test::stance_test {
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
  /// World axes: what the contact forces leave of the weight and the change of momentum. The rows of foot i
  /// are in the axes of leg i, the body behind the hull.
  [[nodiscard]] Vec3<Exact> unbalanced(const State<Exact>& state, const Evaluated<Exact>& e) const {
    return unbalanced_force(model, mechanism, state, e.acceleration, e.lambda,
                            [](const std::string& foot) { return std::size_t(foot.back() - '0'); });
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

// Three feet nearly in a line, by 1e-2 to 1e-6 m: twist and acceleration from given knee rates lose no more
// than the condition number of the rows, 60-digit evaluation as reference.
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
    in["r_a_ddot"] = {Exact::from_decimal("0.5"), Exact(2), Exact(-1)};
    NamedValues<double> rounded;
    for (const auto& [name, values] : in) {
      for (const Exact& x : values) rounded[name].push_back(x.to_double());
    }
    const Values A = stool.call("constraints", in).at("A");
    Eigen::MatrixXd rows(static_cast<Eigen::Index>(A.size()) / 6, 6);
    for (Eigen::Index i = 0; i < rows.size(); ++i)
      rows(i / 6, i % 6) = A[static_cast<std::size_t>(i)].to_double();
    const Eigen::VectorXd s = singular_values(rows).sigma;
    const double condition = s(0) / s(5);
    const auto error = [&](const char* function, const char* output) {
      const Values exact = stool.call(function, in).at(output);
      const std::vector<double> got = in_double(function, rounded).at(output);
      double worst = 0;
      for (std::size_t i = 0; i < got.size(); ++i)
        worst = std::max(worst, abs(Exact::from_double(got[i]) - exact[i]).to_double());
      return worst / largest(exact);
    };
    const double twist = error("kinematics", "eta"), acceleration = error("forward_dynamics", "eta_dot");
    fmt::print("offset {} m: condition {:.1e}, relative errors {:.1e} and {:.1e}\n", offset, condition, twist,
               acceleration);
    EXPECT_LT(twist, 10 * 2.2e-16 * condition);
    EXPECT_LT(acceleration, 20 * 2.2e-16 * condition);  // the bias is quadratic in the twist
  }
}

/// The shipped quadruped on the feet of one of its contact sets, joints held by torques or moved.
struct Quadruped {
  Quadruped(const Scene& scene, bool by_torque)
      : model(specialise(scene.model, scene)), partition(partition_of(model)) {
    DeriveRequest request;
    if (by_torque) request.torque_driven = {"*"};
    request.functions = {"kinematics", "forward_dynamics", "multipliers"};
    request.closed_forms = false;
    derivation = derive(model, request);
    for (const Parameter& p : model.parameters) parameters.push_back(p.value);
    call = interpreting_caller<Exact>(derivation->program, parameters);
    chart_at = chart_finder<Exact>(*derivation);
  }
  /// Newton's law at a random state, at random torques or motion and at a random share of the load.
  [[nodiscard]] Vec3<Exact> unbalanced(SampleSource& source) const {
    const auto draw = [&](std::size_t n) {
      Values v;
      while (v.size() < n) v.push_back(Exact(10) * source.uniform(Exact(-1), Exact(1)));
      return v;
    };
    State<Exact> state = random_state(model, source);
    NamedValues<Exact> in = position_inputs(model, partition, state);
    const std::string chart = chart_prefix(chart_at(in));
    const Partition& reduced = derivation->reduction.partition;
    const bool by_torque = reduced.active.empty();
    in["nu"] = draw(static_cast<std::size_t>(derivation->reduction.kernel.H.cols()));
    if (by_torque) {
      in["tau_a"] = draw(12);
    } else {
      in["r_a_dot"] = draw(12), in["r_a_ddot"] = draw(12);
    }
    const auto velocity = call(chart + "kinematics", in);
    for (int c = 0; c < 6; ++c) state.eta[c] = velocity.at("eta")[static_cast<std::size_t>(c)];
    state.r_dot = by_torque ? velocity.at("r_d_dot") : in["r_a_dot"];
    const auto forward = call(chart + "forward_dynamics", in);
    if (!in["nu"].empty()) in["nu_dot"] = forward.at("nu_dot");
    Values acceleration = forward.at("eta_dot");
    const Values joints = by_torque ? forward.at("r_d_ddot") : in["r_a_ddot"];
    acceleration.insert(acceleration.end(), joints.begin(), joints.end());
    const RankAnalysis& ranks = derivation->reduction.ranks;
    in["lambda_stat"] = draw(static_cast<std::size_t>(ranks.rows - ranks.m_locked));
    const Mechanism<Exact> mechanism = mechanise<Exact>(describe_mechanism(model), parameters);
    return unbalanced_force(model, mechanism, state, acceleration,
                            call(chart + "multipliers", in).at("lambda"), [&](const std::string& foot) {
                              const auto shank =
                                  std::ranges::find(model.bodies, foot + "_shank", &BodyDescription::name);
                              return static_cast<std::size_t>(shank - model.bodies.begin());
                            });
  }

  Model model;
  Partition partition;
  std::unique_ptr<Derivation> derivation;
  Values parameters;
  ProgramCaller<Exact> call;
  ChartFinder<Exact> chart_at;
};

TEST(QuadrupedStance, ForcesOfTwoThreeAndFourFeetCarryTheWeightAndTheChangeOfMomentum) {
  const WorkingDigits digits(60);
  Scene scene = read_scene(std::string(ANHOLON_SOURCE_DIR) + "/models/quadruped_stance/stances.scene.toml");
  ASSERT_EQ(scene.contact_sets.size(), 3U);
  for (const ContactSet& set : scene.contact_sets) {
    const int feet = static_cast<int>(set.contacts.size());
    for (const bool by_torque : {true, false}) {
      SCOPED_TRACE(::testing::Message() << set.name << (by_torque ? ", torques" : ", motion"));
      scene.contact_set = set.name;
      const Quadruped robot(scene, by_torque);
      // two feet leave the turn about the line through them free, three or four nothing
      EXPECT_EQ(robot.derivation->reduction.kernel.H.cols(), by_torque ? 18 - 3 * feet : feet == 2 ? 1 : 0);
      SampleSource source;
      for (int sample = 0; sample < 3; ++sample) {
        const Vec3<Exact> rest = robot.unbalanced(source);
        // of a weight of 250 N; the orientation is orthogonal to 1e-16 only, by which all is turned alike
        for (int i = 0; i < 3; ++i) EXPECT_LT(abs(rest[i]).to_double(), 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace anholon::test::stance_test
