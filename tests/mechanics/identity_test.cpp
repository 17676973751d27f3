// SPDX-License-Identifier: GPL-2.0-or-later
//
// Laws that every shipped robot must satisfy. The derived programs are run in exact arithmetic with 60
// digits, so that a law holds to 1e-25 or is broken: nothing is blamed on rounding.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <filesystem>
#include <map>

#include "check/evaluate_program.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_model.hpp"
#include "number/exact_eigen.hpp"
#include "reduce/decompositions.hpp"
#include "reduce/samples.hpp"

namespace anholon::identity_test {
namespace {

using Values = std::vector<Exact>;

std::vector<std::string> shipped_models() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(ANHOLON_SOURCE_DIR "/models")) {
    const std::string name = entry.path().filename().string();
    if (std::filesystem::exists(entry.path() / (name + ".toml"))) names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

Model shipped(const std::string& name) {
  return read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/" + name + "/" + name + ".toml");
}

double largest(const Values& v) {
  Exact size = 0;
  for (const Exact& x : v) size = std::max(size, abs(x));
  return size.to_double();
}
Values difference(const Values& a, const Values& b) {
  Values d;
  for (std::size_t i = 0; i < a.size(); ++i) d.push_back(a[i] - b[i]);
  return d;
}

/// A model, its program, and states that its constraints admit.
class Robot {
 public:
  Robot(Model model, const DeriveRequest& request)
      : model_(std::move(model)), derivation_(derive(model_, request)), partition_(partition_of(model_)) {
    for (const Parameter& p : model_.parameters) parameters_.push_back(p.value);
    call_ = interpreting_caller<Exact>(derivation_->program, parameters_);
  }

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const Derivation& derivation() const { return *derivation_; }
  [[nodiscard]] const Partition& partition() const { return partition_; }
  [[nodiscard]] const Values& parameters() const { return parameters_; }
  [[nodiscard]] NamedValues<Exact> call(const std::string& function, const NamedValues<Exact>& in) const {
    return call_(function, in);
  }
  [[nodiscard]] Evaluated<Exact> evaluate(const EvaluationInput<Exact>& input) const {
    return evaluate_program(model_, *derivation_, call_, input);
  }

  /// A random state in the working range whose velocity lies in ker (A, B_p, B_a), with random torques.
  [[nodiscard]] EvaluationInput<Exact> admissible(SampleSource& source) const {
    EvaluationInput<Exact> input;
    input.state = random_state(model_, source);
    input.has_torque = true;
    NamedValues<Exact> in = position_inputs(model_, partition_, input.state);
    const bool active = partition_.s_a() > 0;  // else nu alone rules the motion
    const int freedoms = (active ? *derivation_->torque_driven : derivation_->reduction).kernel.H.cols();
    for (int i = 0; i < freedoms; ++i) in[active ? "w" : "nu"].push_back(source.uniform(Exact(-1), Exact(1)));
    NamedValues<Exact> v = call(active ? "torque_driven_kinematics" : "kinematics", in);
    set_velocity(input.state, v["eta"], v["r_p_dot"], v["r_a_dot"]);
    input.r_ddot.assign(model_.coordinates.size(), Exact(0));
    input.tau = input.r_ddot;
    for (const int i : partition_.active) input.tau[coordinate(i)] = source.uniform(Exact(-2), Exact(2));
    return input;
  }
  void set_velocity(State<Exact>& state, const Values& eta, const Values& r_p_dot,
                    const Values& r_a_dot) const {
    const auto components = free_components(model_.group);
    for (std::size_t i = 0; i < eta.size(); ++i) state.eta[components[i]] = eta[i];
    for (std::size_t i = 0; i < r_p_dot.size(); ++i)
      state.r_dot[coordinate(partition_.passive[static_cast<std::size_t>(partition_.n) + i])] = r_p_dot[i];
    for (std::size_t i = 0; i < r_a_dot.size(); ++i)
      state.r_dot[coordinate(partition_.active[i])] = r_a_dot[i];
  }
  /// The same input with r_a_ddot given instead of the torques, taken from an acceleration (n + s).
  [[nodiscard]] EvaluationInput<Exact> imposing(EvaluationInput<Exact> input, const Values& v_dot) const {
    input.has_acceleration = true;
    input.has_torque = false;
    for (const int i : partition_.active) input.r_ddot[coordinate(i)] = v_dot[static_cast<std::size_t>(i)];
    return input;
  }
  [[nodiscard]] Values velocity(const State<Exact>& s) const {
    Values v;
    for (const int c : free_components(model_.group)) v.push_back(s.eta[c]);
    v.insert(v.end(), s.r_dot.begin(), s.r_dot.end());
    return v;
  }
  [[nodiscard]] std::size_t coordinate(int velocity) const {
    return static_cast<std::size_t>(velocity - partition_.n);
  }

 private:
  Model model_;
  std::unique_ptr<Derivation> derivation_;
  Partition partition_;
  Values parameters_;
  ProgramCaller<Exact> call_;
};

/// Any program will do.
DeriveRequest shortest(std::vector<std::string> functions) {
  DeriveRequest request;
  request.closed_forms = false;
  request.optimise = OptimiseFor::speed;
  request.functions = std::move(functions);
  return request;
}
/// Those that a motion with given r_a or given torques needs.
const std::vector<std::string> motion_functions = {"kinematics",
                                                   "reduced_velocities",
                                                   "constraints",
                                                   "reduced_dynamics",
                                                   "forward_dynamics",
                                                   "inverse_torques",
                                                   "multipliers",
                                                   "energies",
                                                   "torque_driven_kinematics",
                                                   "torque_driven_velocities",
                                                   "torque_driven_dynamics",
                                                   "torque_driven_multipliers"};

constexpr int states_tried = 10;

/// All identities of a model, which run in one process, share the program that is emitted for it.
const Robot& shipped_robot(const std::string& name) {
  static std::map<std::string, Robot> robots;
  return robots.try_emplace(name, shipped(name), DeriveRequest{}).first->second;
}

class EveryModel : public testing::TestWithParam<std::string> {
 protected:
  const WorkingDigits digits{60};
};

Values times(const Matrix<Exact>& G, const Values& v) { return G * v; }

TEST_P(EveryModel, KeepsItsConstraintsWhateverNuIs) {
  const Robot& robot = shipped_robot(GetParam());
  if (robot.partition().passive.empty()) GTEST_SKIP() << "the drives rule every velocity";
  std::vector<double> parameters;
  for (const Exact& p : robot.parameters()) parameters.push_back(p.to_double());
  const auto in_double = interpreting_caller<double>(robot.derivation().program, parameters);
  SampleSource source(7);
  for (int i = 0; i < states_tried; ++i) {
    EvaluationInput<Exact> input = robot.admissible(source);
    NamedValues<Exact> in = position_inputs(robot.model(), robot.partition(), input.state);
    for (const int a : robot.partition().active)
      in["r_a_dot"].push_back(input.state.r_dot[robot.coordinate(a)]);
    for (int k = 0; k < robot.derivation().reduction.kernel.H.cols(); ++k)
      in["nu"].push_back(source.uniform(Exact(-2), Exact(2)));
    NamedValues<Exact> v = robot.call("kinematics", in);
    robot.set_velocity(input.state, v["eta"], v["r_p_dot"], in["r_a_dot"]);
    const Evaluated<Exact> e = robot.evaluate(input);
    EXPECT_LT(largest(times(e.G, robot.velocity(input.state))),
              1e-25 * (1 + largest(robot.velocity(input.state))));
    for (std::size_t k = 0; k < e.nu.size(); ++k)  // and reduced_velocities undoes kinematics
      EXPECT_LT(abs(e.nu[k] - in["nu"][k]).to_double(), 1e-25);

    // in double: to the rounding of the sums in a row: 1e-14 of its largest entry times the largest velocity,
    // some hundred roundings of 1.1e-16
    NamedValues<double> rounded;
    for (const auto& [name, values] : in) {
      for (const Exact& x : values) rounded[name].push_back(x.to_double());
    }
    NamedValues<double> w = in_double("kinematics", rounded);
    std::vector<double> u = w["eta"];
    u.resize(static_cast<std::size_t>(e.G.cols()));
    for (std::size_t k = 0; k < w["r_p_dot"].size(); ++k)
      u[static_cast<std::size_t>(robot.partition().passive[w["eta"].size() + k])] = w["r_p_dot"][k];
    for (std::size_t k = 0; k < rounded["r_a_dot"].size(); ++k)
      u[static_cast<std::size_t>(robot.partition().active[k])] = rounded["r_a_dot"][k];
    for (int row = 0; row < e.G.rows(); ++row) {
      double sum = 0, entry = 0, velocity = 0;
      for (int k = 0; k < e.G.cols(); ++k) {
        const double g = e.G(row, k).to_double(), x = u[static_cast<std::size_t>(k)];
        sum += g * x, entry = std::max(entry, std::abs(g)), velocity = std::max(velocity, std::abs(x));
      }
      EXPECT_LT(std::abs(sum), 1e-14 * entry * velocity);
    }
  }
}

TEST_P(EveryModel, AcceleratesAsItsConstraintsAllow) {
  const Robot& robot = shipped_robot(GetParam());
  SampleSource source(11);
  for (int i = 0; i < states_tried; ++i) {
    const EvaluationInput<Exact> input = robot.admissible(source);
    const Evaluated<Exact> driven = robot.evaluate(input);
    const Evaluated<Exact> imposed = robot.evaluate(robot.imposing(input, driven.free_acceleration));
    for (const Values& v_dot : {driven.free_acceleration, imposed.acceleration}) {
      Values sum = times(driven.G, v_dot);
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += driven.bias[k];
      EXPECT_LT(largest(sum), 1e-25 * (1 + largest(v_dot)));
    }
  }
}

// d(T + V)/dt = tau_a . r_a_dot - dissipation, by central differences of the energies along the motion with a
// step of 1e-20: error 1e-40 of the third derivative, and 1e-60 / 1e-20 of rounding.
TEST_P(EveryModel, GainsThePowerOfItsActuatorsAndLosesWhatItDissipates) {
  const Robot& robot = shipped_robot(GetParam());
  if (!robot.model().forces.empty() || !robot.model().wrenches.empty())
    GTEST_SKIP() << "has forces without a potential";
  SampleSource source(13);
  const Exact step = Exact::from_decimal("1e-20");
  for (int i = 0; i < states_tried; ++i) {
    const EvaluationInput<Exact> input = robot.admissible(source);
    const EvaluationInput<Exact> imposed = robot.imposing(input, robot.evaluate(input).free_acceleration);
    const Evaluated<Exact> now = robot.evaluate(imposed);
    const auto energy_at = [&](const Exact& h) {
      EvaluationInput<Exact> moved = input;
      moved.has_torque = false;
      State<Exact>& s = moved.state;
      s.t += h;
      s.p += h * (input.state.R * input.state.eta.linear);
      s.R = s.R + h * (input.state.R * skew(input.state.eta.angular));
      std::size_t k = 0;
      for (const int c : free_components(robot.model().group)) s.eta[c] += h * now.acceleration[k++];
      for (std::size_t c = 0; c < s.r.size(); ++c) s.r[c] += h * s.r_dot[c];
      for (Exact& rate : s.r_dot) rate += h * now.acceleration[k++];
      const Evaluated<Exact> e = robot.evaluate(moved);
      return e.kinetic + e.gravity + e.elastic;
    };
    const Exact rate = (energy_at(step) - energy_at(-step)) / (Exact(2) * step);
    Exact power = -now.dissipated_power;
    for (std::size_t a = 0; a < now.tau_a.size(); ++a)
      power += now.tau_a[a] * imposed.state.r_dot[robot.coordinate(robot.partition().active[a])];
    EXPECT_LT(abs(rate - power).to_double(), 1e-25 * (1 + abs(power).to_double()));
  }
}

// The torques that impose a motion, fed to the torque-driven model, give the motion back: for m = m° they are
// the torques one started from; for m > m° they differ from them by the share that only loads the contacts.
TEST_P(EveryModel, ReturnsItsMotionFromItsTorques) {
  const Robot& robot = shipped_robot(GetParam());
  const RankAnalysis& ranks = robot.derivation().reduction.ranks;
  SampleSource source(17);
  for (int i = 0; i < states_tried; ++i) {
    EvaluationInput<Exact> input = robot.admissible(source);
    const Values motion = robot.evaluate(input).free_acceleration;
    const Evaluated<Exact> imposed = robot.evaluate(robot.imposing(input, motion));
    EXPECT_LT(largest(difference(imposed.acceleration, motion)), 1e-25 * (1 + largest(motion)));
    Exact change = 0;
    for (std::size_t a = 0; a < imposed.tau_a.size(); ++a) {
      Exact& tau = input.tau[robot.coordinate(robot.partition().active[a])];
      change = std::max(change, abs(tau - imposed.tau_a[a]));
      tau = imposed.tau_a[a];
    }
    if (ranks.m == ranks.m_locked) {
      EXPECT_LT(change.to_double(), 1e-25 * (1 + largest(imposed.tau_a)));
    }
    EXPECT_LT(largest(difference(robot.evaluate(input).free_acceleration, motion)),
              1e-25 * (1 + largest(motion)));
  }
}

TEST_P(EveryModel, HasASymmetricPositiveDefiniteReducedMassMatrix) {
  const Robot& robot = shipped_robot(GetParam());
  SampleSource source(19);
  for (int i = 0; i < states_tried; ++i) {
    const EvaluationInput<Exact> input = robot.admissible(source);
    const Evaluated<Exact> e = robot.evaluate(robot.imposing(input, robot.evaluate(input).free_acceleration));
    Eigen::MatrixXd M(e.M_r.rows(), e.M_r.cols());
    for (int r = 0; r < e.M_r.rows(); ++r) {
      for (int c = 0; c < e.M_r.cols(); ++c) {
        EXPECT_LT(abs(e.M_r(r, c) - e.M_r(c, r)).to_double(), 1e-25 * (1 + abs(e.M_r(r, c)).to_double()));
        M(r, c) = e.M_r(r, c).to_double();
      }
    }
    if (M.size() == 0) continue;
    const Eigen::VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd unit_diagonal = scale.asDiagonal() * M * scale.asDiagonal();
    EXPECT_GT(eigenvalues(unit_diagonal).minCoeff(), 1e-9);
  }
}

// Without gravity the world's frame is anybody's choice.
TEST_P(EveryModel, DoesNotKnowWhereTheWorldIsWithoutGravity) {
  Model model = shipped(GetParam());
  model.gravity = {0, 0, 0};
  const GroupKind group = model.group;
  if (group == GroupKind::fixed) GTEST_SKIP() << "the base is fixed";
  const Robot robot(std::move(model), shortest(motion_functions));
  SampleSource source(23);
  for (int i = 0; i < states_tried; ++i) {
    const EvaluationInput<Exact> here = robot.admissible(source);
    EvaluationInput<Exact> there = here;
    State<Exact> change = random_state(robot.model(), source);
    if (!robot.model()
             .positions.empty()) {  // the ground is part of the world: moves within the plane z = 0 remain
      change.R = AxisRotation<Exact>{2, cos(change.p.z), sin(change.p.z)}.matrix();
      change.p.z = 0;
    }
    const bool turns = group == GroupKind::SE3 || group == GroupKind::SE2 || group == GroupKind::SO3;
    if (turns) {
      there.state.R = change.R * here.state.R;
      there.state.p = change.R * here.state.p;
    }
    if (group != GroupKind::SO3) there.state.p += change.p;
    const Values motion = robot.evaluate(here).free_acceleration;
    EXPECT_LT(largest(difference(robot.evaluate(there).free_acceleration, motion)),
              1e-25 * (1 + largest(motion)));
    const Evaluated<Exact> a = robot.evaluate(robot.imposing(here, motion));
    const Evaluated<Exact> b = robot.evaluate(robot.imposing(there, motion));
    EXPECT_LT(largest(difference(a.tau_a, b.tau_a)), 1e-25 * (1 + largest(a.tau_a)));
    EXPECT_LT(largest(difference(a.acceleration, b.acceleration)), 1e-25 * (1 + largest(motion)));
  }
}

// Every choice of free velocities that the constraints admit gives the same motion and the same torques.
TEST_P(EveryModel, MovesTheSameWhateverTheKernelBasis) {
  const Robot usual(shipped(GetParam()), shortest(motion_functions));
  const int k = usual.derivation().reduction.kernel.H.cols();
  if (k == 0 || usual.model().rows.empty()) GTEST_SKIP() << "no kernel to choose";
  const std::vector<std::string> names = velocity_names(usual.model());
  const std::vector<int>& passive = usual.partition().passive;
  std::vector<bool> chosen(passive.size(), false);
  std::fill(chosen.begin(), chosen.begin() + k, true);
  int tried = 0;
  do {
    Model model = shipped(GetParam());
    model.free_velocities.clear();  // what the description wants
    std::string text;
    for (std::size_t i = 0; i < passive.size(); ++i) {
      if (!chosen[i]) continue;
      model.free_velocities.push_back(names[static_cast<std::size_t>(passive[i])]);
      text += model.free_velocities.back() + ' ';
    }
    SCOPED_TRACE(text);
    std::unique_ptr<Robot> other;
    try {
      other = std::make_unique<Robot>(std::move(model), shortest(motion_functions));
    } catch (const std::exception&) {
      continue;  // these velocities are not independent
    }
    ++tried;
    SampleSource source(29);
    for (int i = 0; i < 3; ++i) {
      const EvaluationInput<Exact> input = usual.admissible(source);
      const EvaluationInput<Exact> imposed = usual.imposing(input, usual.evaluate(input).free_acceleration);
      const Evaluated<Exact> a = usual.evaluate(imposed);
      const Evaluated<Exact> b = other->evaluate(imposed);
      EXPECT_LT(largest(difference(a.acceleration, b.acceleration)), 1e-25 * (1 + largest(a.acceleration)));
      EXPECT_LT(largest(difference(a.tau_a, b.tau_a)), 1e-25 * (1 + largest(a.tau_a)));
      EXPECT_LT(largest(difference(a.lambda, b.lambda)), 1e-25 * (1 + largest(a.lambda)));
    }
  } while (tried < 4 && std::prev_permutation(chosen.begin(), chosen.end()));
  EXPECT_GT(tried, 0);
}

INSTANTIATE_TEST_SUITE_P(Shipped, EveryModel, testing::ValuesIn(shipped_models()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace anholon::identity_test
