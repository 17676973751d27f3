// SPDX-License-Identifier: GPL-2.0-or-later
//
// The reference vectors (mobile pendulum, bicycle, rigid and soft snake-board), which were made without the
// recursion: every way of evaluating a model must meet them, and so must the program in the basis that the
// article documents.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <memory>

#include "anholon/free_dynamics.hpp"
#include "check/evaluate.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "mechanics/compare_reference.hpp"
#include "number/exact_eigen.hpp"
#include "reduce/decompositions.hpp"

namespace anholon::reference_test {
namespace {

using test::Json;
using Dense = DynamicMatrix<Exact>;
using Column = DynamicVector<Exact>;

struct System {
  const char* model;
  const char* reference;
};
void PrintTo(const System& s, std::ostream* stream) { *stream << s.model; }

const System systems[] = {{"mobile_pendulum", "A_mobile_pendulum"},
                          {"bicycle", "B_bicycle"},
                          {"rigid_snakeboard", "C_rigid_snakeboard"},
                          {"soft_snakeboard", "C_soft_snakeboard"}};

class Reference : public testing::TestWithParam<System> {
 protected:
  static void SetUpTestSuite() {
    setenv("ANHOLON_CACHE", (std::string(ANHOLON_BINARY_DIR) + "/compiled").c_str(), 0);
  }
  Reference()
      : model(read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/" + GetParam().model + "/" +
                         GetParam().model + ".toml")),
        reference(test::read_reference(GetParam().reference)),
        states(read_states(
            std::string(ANHOLON_SOURCE_DIR) + "/tests/reference/" + GetParam().reference + ".json", model)) {}

  [[nodiscard]] Json evaluate(EvaluationMethod method) const {
    EvaluateRequest request;
    request.method = method;
    return evaluate_states(model, states, request);
  }
  void expect_agreement(const Json& answer, const char* tolerance) const {
    for (const test::Comparison& c : test::compare(reference, answer, Exact::from_decimal(tolerance))) {
      EXPECT_TRUE(c.fault.empty() && c.worst_of_allowed <= 1)
          << c.quantity << ": " << c.fault << " error " << c.error << " is " << c.worst_of_allowed
          << " times what is allowed, at " << c.where;
    }
  }

  Model model;
  Json reference;
  StatesFile states;
};

TEST_P(Reference, IsMetByTheGeneratedCode) {
  expect_agreement(evaluate(EvaluationMethod::generated), "1e-12");
}

TEST_P(Reference, IsMetByTheNumericRecursion) {
  expect_agreement(evaluate(EvaluationMethod::recursion), "1e-12");
}

// 1e-25: the references print 30 digits, the evaluation carries 50
TEST_P(Reference, IsMetByTheExactRecursion) { expect_agreement(evaluate(EvaluationMethod::exact), "1e-25"); }

/// The derived tape itself, run in exact arithmetic: no rounding can hide a wrong term.
TEST_P(Reference, IsMetByTheDerivedProgramRunExactly) {
  const WorkingDigits digits(60);
  const auto derivation = derive(model);
  const auto call = interpreting_caller<Exact>(derivation->program, states.parameters);
  Json result;
  for (const auto& entry : states.states) {
    const Evaluated<Exact> e = evaluate_program(model, *derivation, call, entry.input);
    result["states"].push_back(
        {{"label", entry.label}, {"outputs", answer(model, states, e, entry.input, 50)}});
  }
  expect_agreement(result, "1e-25");
}

/// The reference's variant "without terms quadratic in r_e in T" is `deformation = "linear"`: its energy
/// loses the terms of second order, the forces follow.
TEST(LinearDeformation, IsTheVariantOfTheReference) {
  Model model = read_model(ANHOLON_SOURCE_DIR "/models/soft_snakeboard/soft_snakeboard.toml");
  for (BodyDescription& body : model.bodies) body.deformation = Deformation::linear;
  const MechanismDescription description = describe_mechanism(model);
  const WorkingDigits digits(50);
  std::vector<Exact> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value);
  const Mechanism<Exact> mechanism = mechanise<Exact>(description, parameters);
  FreeDynamics<Exact> dynamics(mechanism);
  const Json reference = test::read_reference("C_soft_snakeboard");
  for (const Json& entry : reference.at("states")) {
    SCOPED_TRACE(entry.at("label").get<std::string>());
    const Json& in = entry.at("inputs");
    const Json& out = entry.at("outputs");
    const Json& variant = out.at("variant_without_terms_quadratic_in_r_e_in_T");
    std::map<std::string, std::pair<Exact, Exact>> by_name = {
        {"r1", {test::number(in.at("r_a")[0]), test::number(in.at("rdot_a")[0])}},
        {"r3", {test::number(in.at("r_a")[1]), test::number(in.at("rdot_a")[1])}},
        {"re3", {test::number(in.at("r_p")[0]), test::number(in.at("rdot_p")[0])}},
        {"re4", {test::number(in.at("r_p")[1]), test::number(in.at("rdot_p")[1])}}};
    State<Exact> state;
    for (int i = 0; i < 3; ++i)
      state.eta[i < 2 ? i : 5] = test::number(in.at("eta")[static_cast<std::size_t>(i)]);
    for (const Coordinate& c : model.coordinates) {
      state.r.push_back(by_name.at(c.name).first);
      state.r_dot.push_back(by_name.at(c.name).second);
    }
    const std::vector<Exact> force = dynamics.forces(state);
    const auto expect_near = [](const Exact& have, const Json& want, const std::string& what) {
      EXPECT_LT(abs(have - test::number(want)), Exact::from_decimal("1e-28"))
          << what;  // 30 digits are printed
    };
    for (std::size_t i = 0; i < 3; ++i) expect_near(force[i], variant.at("f")[i], "f");
    for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
      if (model.coordinates[i].name == "re3") expect_near(force[3 + i], variant.at("Q_p")[0], "Q_re3");
      if (model.coordinates[i].name == "re4") expect_near(force[3 + i], variant.at("Q_p")[1], "Q_re4");
    }
  }
}

TEST_P(Reference, HasTheRanksAndTheClassOfTableI) {
  DeriveRequest request;
  request.functions = {"kinematics"};
  const auto derivation = derive(model, request);
  const RankAnalysis& ranks = derivation->reduction.ranks;
  const Json& outputs = reference["states"][0]["outputs"];
  const Json& table = outputs["table_I"];
  EXPECT_EQ(ranks.rows, table["m"].get<int>());  // no file has a row that is redundant altogether
  EXPECT_EQ(ranks.m, outputs["rank_A_Bp_Ba"].get<int>());
  EXPECT_EQ(ranks.m_locked, table["m_o"].get<int>());
  EXPECT_EQ(static_cast<int>(derivation->reduction.partition.passive.size()), table["n_plus_sp"].get<int>());
  EXPECT_EQ(derivation->reduction.kernel.H.cols(), outputs["kernel_dimension"].get<int>());
  const bool undetermined = table["lambda_stat"].get<std::string>() != "zero";
  EXPECT_EQ(ranks.table_I_class(derivation->reduction.partition),
            std::string("H nonzero, lambda_stat ") + (undetermined ? "undetermined" : "= 0") + " (dynamic)");
}

Dense dense(const Json& rows, Eigen::Index count, Eigen::Index cols) {
  Dense m = Dense::Zero(count, cols);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t j = 0; j < rows[i].size(); ++j)
      m(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = test::number(rows[i][j]);
  }
  return m;
}
Column column(const Json& list) {
  Column v(static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i) v(static_cast<Eigen::Index>(i)) = test::number(list[i]);
  return v;
}
Column column(const std::vector<Exact>& list) { return to_eigen(list); }
Dense least_squares(const Dense& A, const Dense& b) {  // A has full column rank
  return (A.transpose() * A).eval().partialPivLu().solve((A.transpose() * b).eval());
}
double magnitude(const Dense& m) {
  Exact s = 0;
  for (Eigen::Index i = 0; i < m.size(); ++i) s = std::max(s, abs(m.data()[i]));
  return s.to_double();
}

/// Kernel and J as the article documents them, at any shape.
struct DocumentedBasis {
  Dense H, J;
};

DocumentedBasis documented_basis(const Model& model, const std::vector<Exact>& parameters,
                                 const State<Exact>& state, const Dense& program_J) {
  const auto parameter = [&](const std::string& name) {
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (model.parameters[i].name == name) return parameters[i];
    }
    throw std::logic_error("no parameter " + name);
  };
  if (model.name == "mobile_pendulum") {  // (38)
    DocumentedBasis b{Dense::Zero(2, 1), Dense::Zero(2, 2)};
    b.H(1, 0) = 1;
    b.J(0, 0) = parameter("R");
    return b;
  }
  if (model.name ==
      "bicycle") {  // the one solution of (46) with Omega_Y = 0; its values are compared with (54)
    DocumentedBasis b{Dense::Zero(7, 1), program_J};
    b.H(4, 0) = 1;
    b.J.row(4).setZero();
    return b;
  }
  const auto passive = static_cast<Eigen::Index>(model.name == "soft_snakeboard" ? 5 : 3);  // (60)
  DocumentedBasis b{Dense::Zero(passive, passive - 2), Dense::Zero(passive, 2)};
  const Exact& r1 = state.r[0];
  b.H(0, 0) = Exact(-2) * parameter("l") * cos(r1) * cos(r1);
  b.H(2, 0) = sin(Exact(2) * r1);
  for (Eigen::Index i = 3; i < passive; ++i) b.H(i, i - 2) = 1;
  return b;
}

/// eta_r = T nu + K r_a_dot takes the program's reduced velocities to the documented ones.
struct BasisChange {
  Dense T, K;
};

// M_reduced = H^T M H and F_reduced = M_reduced eta_r_dot in the documented basis, from the program's M_r,
// f_r:
//   M_r = T^T M_reduced T,    f_r = T^T (F_reduced - M_reduced (T_dot nu + K r_a_ddot + K_dot r_a_dot)).
// T_dot and K_dot by central differences along the motion with a step of 1e-20: error 1e-40 of the third
// derivative, plus 1e-70 / 1e-20 of rounding.
TEST_P(Reference, IsMetInTheDocumentedBasis) {
  const WorkingDigits digits(70);
  DeriveRequest request;
  request.functions = {"kinematics",      "reduced_velocities", "constraints",
                       "free_dynamics",   "reduced_dynamics",   "forward_dynamics",
                       "inverse_torques", "multipliers",        "energies"};
  request.inverse = Inverse::leading;  // the J of (38) is that of the leading wheel
  request.leading_rows = {0};
  const auto derivation = derive(model, request);
  const auto call = interpreting_caller<Exact>(derivation->program, states.parameters);
  const auto change_at = [&](const EvaluationInput<Exact>& input, Evaluated<Exact>& e) {
    e = evaluate_program(model, *derivation, call, input);
    const Dense H = to_eigen(e.H);
    const Dense J = to_eigen(e.J);
    const DocumentedBasis basis = documented_basis(model, states.parameters, input.state, J);
    const BasisChange change{least_squares(basis.H, H), least_squares(basis.H, Dense(J - basis.J))};
    EXPECT_LT(magnitude(basis.H * change.T - H), 1e-30);  // both span the same kernel
    EXPECT_LT(magnitude(basis.H * change.K - (J - basis.J)), 1e-30);
    return change;
  };
  const Exact step = Exact::from_decimal("1e-20");
  for (std::size_t s = 0; s < states.states.size(); ++s) {
    SCOPED_TRACE(states.states[s].label);
    EvaluationInput<Exact> input = states.states[s].input;
    input.has_torque = false;
    const Json& outputs = reference["states"][s]["outputs"];
    const Json& documented = outputs["reduced_in_documented_basis"];
    Evaluated<Exact> e, unused;
    const BasisChange now = change_at(input, e);
    const auto shifted = [&](const Exact& h) {
      EvaluationInput<Exact> moved = input;  // the kernels of these systems depend on r alone
      for (std::size_t i = 0; i < moved.state.r.size(); ++i) moved.state.r[i] += h * input.state.r_dot[i];
      return change_at(moved, unused);
    };
    const BasisChange later = shifted(step), earlier = shifted(-step);
    const Dense T_dot = (later.T - earlier.T) / (Exact(2) * step);
    const Dense K_dot = (later.K - earlier.K) / (Exact(2) * step);

    const DocumentedBasis basis = documented_basis(model, states.parameters, input.state, to_eigen(e.J));
    const Eigen::Index k = basis.H.cols();
    EXPECT_LT(magnitude(dense(documented["H"], basis.H.rows(), k) - basis.H), 1e-28);
    EXPECT_LT(magnitude(dense(documented["J"], basis.J.rows(), basis.J.cols()) - basis.J), 1e-28);
    Column r_a_dot(static_cast<Eigen::Index>(derivation->reduction.partition.s_a())), r_a_ddot = r_a_dot;
    for (Eigen::Index i = 0; i < r_a_dot.size(); ++i) {
      const auto at =
          static_cast<std::size_t>(derivation->reduction.partition.active[static_cast<std::size_t>(i)] -
                                   derivation->reduction.partition.n);
      r_a_dot(i) = input.state.r_dot[at], r_a_ddot(i) = input.r_ddot[at];
    }
    const Dense M_documented = dense(documented["M_reduced"], k, k);
    const Column rate = T_dot * column(e.nu) + now.K * r_a_ddot + K_dot * r_a_dot;
    const double scale =
        1 + magnitude(now.T) * magnitude(now.T);  // 1e-25 of what the change of basis makes of the numbers
    EXPECT_LT(magnitude(now.T * column(e.nu) + now.K * r_a_dot - column(documented["eta_r"])),
              1e-25 * (1 + magnitude(now.T)));
    EXPECT_LT(magnitude(now.T.transpose() * M_documented * now.T - to_eigen(e.M_r)), 1e-25 * scale);
    const Column F = column(documented["F_reduced"]);
    EXPECT_LT(magnitude(now.T.transpose() * (F - M_documented * rate) - column(e.f_r)),
              1e-25 * scale * (1 + magnitude(F) + magnitude(rate)));
    EXPECT_LT(magnitude(now.T * column(e.nu_dot) + rate - column(documented["eta_r_dot"])),
              1e-25 * scale * (1 + magnitude(F) + magnitude(rate)));
  }
}

INSTANTIATE_TEST_SUITE_P(Article, Reference, testing::ValuesIn(systems),
                         [](const auto& info) { return std::string(info.param.model); });

// ---- the three rows of (44)
// -------------------------------------------------------------------------------------

class PendulumTorques : public testing::Test {
 protected:
  Model model = read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/mobile_pendulum/mobile_pendulum.toml");
  Json reference = test::read_reference("A_mobile_pendulum");
  StatesFile states =
      read_states(std::string(ANHOLON_SOURCE_DIR) + "/tests/reference/A_mobile_pendulum.json", model);

  std::unique_ptr<Derivation> derived(Inverse inverse, const std::vector<int>& rows) const {
    DeriveRequest request;
    request.inverse = inverse;
    request.leading_rows = rows;
    request.functions = {"kinematics",      "reduced_velocities", "forward_dynamics",
                         "inverse_torques", "multipliers",        "constraints"};
    return derive(model, request);
  }
  static constexpr const char* front = "T=0 (wheel 1 leading)";
  static constexpr const char* rear = "T=-X/R (wheel 2 leading)";
  static constexpr const char* equal = "T=-X/(2R) (equal sharing = minimum-norm lambda)";
  static constexpr const char* X = "X = M R^2 rddot_1 + m R l (cos r3 rddot_3 - sin r3 rdot_3^2)";
};

/// How far every method is from an exact value: the references print 30 digits, double carries 16.
struct Method {
  EvaluationMethod method;
  double tolerance;
};
constexpr Method methods[] = {{EvaluationMethod::generated, 1e-12},
                              {EvaluationMethod::recursion, 1e-12},
                              {EvaluationMethod::exact, 1e-25}};

TEST_F(PendulumTorques, FollowTheLeadingWheelOrAreSharedEqually) {
  struct Choice {
    Inverse inverse;
    std::vector<int> rows;
    const char* key;
    const char* lambda;
  };
  for (const Choice& choice :
       {Choice{Inverse::leading, {0}, front, "lambda"}, Choice{Inverse::leading, {1}, rear, "lambda"},
        Choice{Inverse::pseudo, {}, equal, "lambda_min_norm"}}) {
    SCOPED_TRACE(choice.key);
    const auto derivation = derived(choice.inverse, choice.rows);
    const auto call = interpreting_caller<Exact>(derivation->program, states.parameters);
    for (std::size_t s = 0; s < states.states.size(); ++s) {
      SCOPED_TRACE(states.states[s].label);
      const Column want = column(reference["states"][s]["outputs"]["torques_eq44"][choice.key]);
      const Evaluated<Exact> e = evaluate_program(model, *derivation, call, states.states[s].input);
      EXPECT_LT(magnitude(column(e.tau_a) - want), 1e-25 * (1 + magnitude(want)));
    }
    for (const auto& [method, tolerance] : methods) {
      EvaluateRequest request;
      request.method = method;
      request.inverse = choice.inverse;
      request.leading_rows = choice.rows;
      const Json answered = evaluate_states(model, states, request);
      for (std::size_t s = 0; s < states.states.size(); ++s) {
        SCOPED_TRACE(states.states[s].label);
        const Column want = column(reference["states"][s]["outputs"]["torques_eq44"][choice.key]);
        const Json& given = answered["states"][s]["outputs"]["given_r_a"];
        EXPECT_LT(magnitude(column(given["tau_a"]) - want), tolerance * (1 + magnitude(want)));
        // the wheel's own balance: tau_i = J_w r_i_ddot + R lambda_i
        const Column lambda = column(given[choice.lambda]);
        for (Eigen::Index i = 0; i < 2; ++i) {
          const Exact own = states.parameters[2] * states.states[s].input.r_ddot[static_cast<std::size_t>(i)];
          EXPECT_LT(abs(want(i) - own - states.parameters[3] * lambda(i)).to_double(),
                    tolerance * (1 + magnitude(want)));
        }
        if (choice.rows.empty()) continue;  // the other wheel's row carries nothing
        const Eigen::Index idle = choice.rows[0] == 0 ? 1 : 0;
        EXPECT_TRUE(lambda(idle).is_zero());
      }
    }
  }
}

TEST_F(PendulumTorques, TakeTheStaticLoadingOfTheStatesFile) {
  ASSERT_EQ(model.parameters[3].name, "R");
  for (const auto& [method, tolerance] : methods) {
    EvaluateRequest request;
    request.method = method;
    request.inverse = Inverse::leading;
    request.leading_rows = {0};
    for (const auto& [key, share] :
         {std::pair(front, Exact(0)), std::pair(rear, Exact(1)), std::pair(equal, Exact::ratio(1, 2))}) {
      StatesFile loaded = states;
      for (std::size_t s = 0; s < states.states.size(); ++s) {
        // T = -share X/R goes to (1, -1); the basis N = (-1, 1) of the redundant second row has s = -T
        const Exact load =
            test::number(reference["states"][s]["outputs"]["torques_eq44"][X]) / states.parameters[3];
        loaded.states[s].input.lambda_stat = {share * load};
      }
      const Json answered = evaluate_states(model, loaded, request);
      for (std::size_t s = 0; s < states.states.size(); ++s) {
        const Column want = column(reference["states"][s]["outputs"]["torques_eq44"][key]);
        EXPECT_LT(magnitude(column(answered["states"][s]["outputs"]["given_r_a"]["tau_a"]) - want),
                  tolerance * (1 + magnitude(want)))
            << key << ", " << states.states[s].label;
      }
    }
  }
  StatesFile wrong = states;
  wrong.states[0].input.lambda_stat = {Exact(1), Exact(2)};
  EvaluateRequest leading;
  leading.inverse = Inverse::leading;
  EXPECT_THROW(evaluate_states(model, wrong, leading), ModelError);
  wrong.states[0].input.lambda_stat = {Exact(1)};
  EXPECT_NO_THROW(evaluate_states(model, wrong, leading));
  EXPECT_THROW(evaluate_states(model, wrong, {}), ModelError);
}

// tau_a = tau_a(0) - B_a^T N s with B_a = -R 1 and N = (-1, 1), or its negative: s of size X/R hands the load
// to the other wheel, half of it shares the load.
TEST_F(PendulumTorques, MoveFromWheelToWheelWithTheStaticLoading) {
  const auto derivation = derived(Inverse::leading, {0});
  const auto call = interpreting_caller<Exact>(derivation->program, states.parameters);
  const Partition partition = partition_of(model);
  for (std::size_t s = 0; s < states.states.size(); ++s) {
    SCOPED_TRACE(states.states[s].label);
    const EvaluationInput<Exact>& input = states.states[s].input;
    const Json& eq44 = reference["states"][s]["outputs"]["torques_eq44"];
    auto in = position_inputs(model, partition, input.state);
    in["eta"] = {input.state.eta[0]}, in["r_p_dot"] = {input.state.r_dot[2]};
    in["r_a_dot"] = {input.state.r_dot[0], input.state.r_dot[1]};
    in["r_a_ddot"] = {input.r_ddot[0], input.r_ddot[1]};
    in["nu"] = call("reduced_velocities", in)["nu"];
    in["nu_dot"] = call("forward_dynamics", in)["nu_dot"];
    const std::vector<Exact> N = call("constraints", in)["lambda_stat_basis"];
    ASSERT_EQ(N.size(), 2u);
    EXPECT_EQ(N[0], -N[1]);
    const Exact R = states.parameters[3];
    ASSERT_EQ(model.parameters[3].name, "R");
    const Exact load = test::number(eq44[X]) / (R * N[1]);
    for (const auto& [share, key] :
         {std::pair(Exact(0), front), std::pair(load, rear), std::pair(load / Exact(2), equal)}) {
      in["lambda_stat"] = {share};
      const Column want = column(eq44[key]);
      EXPECT_LT(magnitude(column(call("inverse_torques", in)["tau_a"]) - want), 1e-25 * (1 + magnitude(want)))
          << key;
      const std::vector<Exact> lambda = call("multipliers", in)["lambda"];
      // the wheel's own balance: tau_i = J_w r_i_ddot + R lambda_i
      for (std::size_t i = 0; i < 2; ++i)
        EXPECT_LT(
            abs(want(static_cast<Eigen::Index>(i)) - states.parameters[2] * input.r_ddot[i] - R * lambda[i])
                .to_double(),
            1e-25 * (1 + magnitude(want)));
    }
  }
}

}  // namespace
}  // namespace anholon::reference_test
