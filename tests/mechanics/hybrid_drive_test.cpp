// SPDX-License-Identifier: GPL-2.0-or-later
//
// Joints driven by torque, joints driven by motion, and any mixture of them move alike: the torques that a
// motion needs, given to some of the joints in place of their motion, give the motion back.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "check/evaluate_program.hpp"
#include "describe/read_model.hpp"
#include "reduce/samples.hpp"

namespace anholon::hybrid_drive_test {
namespace {

using Values = std::vector<double>;
using Named = NamedValues<double>;

class Driven {
 public:
  Driven(const Model& model, std::set<std::string> by_torque) : model_(model) {
    DeriveRequest request;
    request.torque_driven = std::move(by_torque);
    request.functions = {"kinematics", "reduced_velocities", "forward_dynamics", "inverse_torques"};
    request.closed_forms = false;
    derivation_ = derive(model, request);
    std::vector<double> parameters;
    for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
    call_ = interpreting_caller<double>(derivation_->program, parameters);
    chart_at_ = chart_finder<double>(*derivation_);
  }
  [[nodiscard]] const Partition& partition() const { return derivation_->reduction.partition; }
  [[nodiscard]] int freedoms() const { return derivation_->reduction.kernel.H.cols(); }
  [[nodiscard]] Named operator()(const std::string& function, const Named& in) const {
    return call_(chart_prefix(chart_at_(in)) + function, in);
  }
  /// Random coordinates of the static loading, which no motion may feel.
  [[nodiscard]] Values loading(SampleSource& source) const {
    const RankAnalysis& ranks = derivation_->reduction.ranks;
    Values s;
    for (int i = ranks.m_locked; i < ranks.rows; ++i) s.push_back(2 * source.uniform() - 1);
    return s;
  }

  /// All velocities or accelerations (n + s): those of eta, the passive and the torque-driven coordinates
  /// from a function's blocks, the others from `imposed`.
  [[nodiscard]] Values merged(const Named& out, bool accelerations, const Values& imposed) const {
    Values passive;
    for (const char* block : {accelerations ? "eta_dot" : "eta", accelerations ? "r_p_ddot" : "r_p_dot",
                              accelerations ? "r_d_ddot" : "r_d_dot"}) {
      const auto found = out.find(block);
      if (found != out.end()) passive.insert(passive.end(), found->second.begin(), found->second.end());
    }
    Values all(passive.size() + imposed.size());
    for (std::size_t i = 0; i < passive.size(); ++i)
      all[static_cast<std::size_t>(partition().passive[i])] = passive[i];
    for (std::size_t i = 0; i < imposed.size(); ++i)
      all[static_cast<std::size_t>(partition().active[i])] = imposed[i];
    return all;
  }
  /// Inputs at a state: velocities (n + s), accelerations of what is imposed, torques of what is driven.
  [[nodiscard]] Named inputs(const State<double>& state, const Values& velocity, const Values& acceleration,
                             const Values& torque) const {
    const Partition original = partition_of(model_);
    const Partition& p = partition();
    Named in = position_inputs(model_, original, state);
    const auto pick = [](const Values& from, auto begin, auto end) {
      Values v;
      for (auto i = begin; i != end; ++i) v.push_back(from[static_cast<std::size_t>(*i)]);
      return v;
    };
    const auto begin = p.passive.begin(), r_p = begin + p.n, r_d = begin + std::ssize(original.passive);
    in["eta"] = pick(velocity, begin, r_p), in["r_p_dot"] = pick(velocity, r_p, r_d);
    in["r_d_dot"] = pick(velocity, r_d, p.passive.end());
    in["r_a_dot"] = pick(velocity, p.active.begin(), p.active.end());
    in["r_a_ddot"] = pick(acceleration, p.active.begin(), p.active.end());
    in[p.active.empty() ? "tau_a" : "tau_d"] = pick(torque, r_d, p.passive.end());
    std::erase_if(in, [](const auto& block) { return block.second.empty(); });
    if (freedoms() > 0) in["nu"] = (*this)("reduced_velocities", in).at("nu");
    return in;
  }

 private:
  const Model& model_;
  std::unique_ptr<Derivation> derivation_;
  ProgramCaller<double> call_;
  ChartFinder<double> chart_at_;
};

Values draw(std::size_t n, SampleSource& source) {
  Values v;
  while (v.size() < n) v.push_back(2 * source.uniform() - 1);
  return v;
}

State<double> rounded(const State<Exact>& exact) {
  State<double> state;
  for (std::size_t i = 0; i < 9; ++i) state.R.m[i] = exact.R.m[i].to_double();
  for (int i = 0; i < 3; ++i) state.p[i] = exact.p[i].to_double();
  for (const Exact& r : exact.r) state.r.push_back(r.to_double());
  state.r_dot.assign(state.r.size(), 0);
  return state;
}

double distance(const Values& a, const Values& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = std::max(difference, std::abs(a[i] - b[i]));
    size = std::max(size, std::abs(b[i]));
  }
  return difference / size;
}

class HybridDrive : public testing::TestWithParam<std::string> {};

TEST_P(HybridDrive, TorquesOfAMotionGiveTheMotionBack) {
  const Model model = read_model(fmt::format("{0}/models/{1}/{1}.toml", ANHOLON_SOURCE_DIR, GetParam()));
  std::vector<std::string> active;
  for (const Coordinate& c : model.coordinates) {
    if (c.drive == Drive::active) active.push_back(c.name);
  }
  const Driven free(model, {"*"}), moved(model, {});
  for (unsigned mask = 1; mask < (1U << active.size()); ++mask) {  // every mixture
    std::set<std::string> by_torque;
    for (std::size_t i = 0; i < active.size(); ++i) {
      if (((mask >> i) & 1U) != 0) by_torque.insert(active[i]);
    }
    SCOPED_TRACE(fmt::format("{} of {} joints by torque, mask {}", by_torque.size(), active.size(), mask));
    const Driven hybrid(model, by_torque);
    SampleSource source;
    for (int sample = 0; sample < 5; ++sample) {
      const State<double> state = rounded(random_state(model, source));
      // A motion that every constraint allows: that of random torques.
      Named in = position_inputs(model, partition_of(model), state);
      in["nu"] = draw(static_cast<std::size_t>(free.freedoms()), source);
      in["tau_a"] = draw(active.size(), source);
      const Values velocity = free.merged(free("kinematics", in), false, {});
      const Values acceleration = free.merged(free("forward_dynamics", in), true, {});
      // The torques that it needs, at any share of the load.
      Named motion = moved.inputs(state, velocity, acceleration, {});
      if (moved.freedoms() > 0) motion["nu_dot"] = moved("forward_dynamics", motion).at("nu_dot");
      if (const Values loading = moved.loading(source); !loading.empty()) motion["lambda_stat"] = loading;
      const Values tau = moved("inverse_torques", motion).at("tau_a");
      Values torque(velocity.size(), 0.0);
      for (std::size_t i = 0; i < tau.size(); ++i)
        torque[static_cast<std::size_t>(moved.partition().active[i])] = tau[i];
      const Named mixed = hybrid.inputs(state, velocity, acceleration, torque);
      Values imposed;
      for (const int i : hybrid.partition().active)
        imposed.push_back(acceleration[static_cast<std::size_t>(i)]);
      const Values back = hybrid.merged(hybrid("forward_dynamics", mixed), true, imposed);
      EXPECT_LT(distance(back, acceleration), 1e-11);  // the bound of the issue: rounding times conditions
    }
  }
}

// One and two driven joints, passive wheels and hinges, over-constrained and hyperstatic robots.
INSTANTIATE_TEST_SUITE_P(Models, HybridDrive,
                         testing::Values("rigid_snakeboard", "soft_snakeboard", "bicycle", "mobile_pendulum",
                                         "trailer", "roller_racer", "five_bar", "differential_drive",
                                         "ackermann_car", "trikke", "wheeled_snake3"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace anholon::hybrid_drive_test
