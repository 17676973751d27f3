// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <type_traits>

#include "anholon/free_dynamics.hpp"
#include "check/compiled_caller.hpp"
#include "check/error_measure.hpp"
#include "check/evaluate_program.hpp"
#include "check/evaluate_recursion.hpp"
#include "check/output_record.hpp"
#include "check/relative_condition.hpp"
#include "check/states_json.hpp"
#include "describe/mechanise.hpp"
#include "optimise/accuracy/rounding_shares.hpp"
#include "reduce/samples.hpp"

namespace anholon {
namespace {

constexpr int formula_samples = 40;  // the exact recursion with its factorisations is slow

/// Blocks of one kind of quantity: a pose has no scale of its own parts, a twist has two.
class Verifier {
 public:
  Verifier(const Model& model, const Derivation& derivation)
      : model_(model),
        program_(derivation.program),
        derivation_(derivation),
        partition_(partition_of(model)),
        reduced_(derivation.reduction.partition),
        description_(describe_mechanism(model)) {
    for (const Parameter& p : model.parameters) {
      const double rounded = p.value.to_double();  // double code is given these numbers
      parameters_.push_back(Exact::from_double(rounded));
      double_parameters_.push_back(rounded);
    }
    chart_at_ = chart_finder<Exact>(derivation);
    torque_driven_chart_at_ = chart_finder<Exact>(derivation, "torque_driven_");
    exact_ = interpreting_caller<Exact>(program_, parameters_);
    extended_ = interpreting_caller<long double>(
        program_, std::vector<long double>(double_parameters_.begin(), double_parameters_.end()));
    compiled_ = compiled_caller(program_, parameters_);
  }

  Verification run(const VerificationPlan& plan, const std::function<void(int)>& progress) {
    bound_ = plan.bound;
    const WorkingDigits precision(verification_digits);
    const Mechanism<Exact> mechanism = mechanise<Exact>(description_, parameters_);
    const Mechanism<double> rounded = mechanise<double>(description_, double_parameters_);
    SampleSource source(4);
    for (int s = 0; s < plan.samples; ++s) {
      if (progress) progress(s);
      sample_ = s + 1;
      const NamedValues<Exact> inputs = random_inputs(source, s < exactly_judged);
      if (s < exactly_judged) {
        compare(inputs, exact_, inputs);
      } else {
        compare(inputs, extended_, in_long_double(inputs));
      }
      if (s < formula_samples) check_formulas(mechanism, rounded, inputs);
    }
    return summarise(plan.samples);
  }

 private:
  /// Position in the working range; velocities, accelerations, torques in +-1. Every value is a double.
  NamedValues<Exact> random_inputs(SampleSource& source, bool is_exact) {
    state_ = random_state(model_, source);
    NamedValues<Exact> in = position_inputs(model_, partition_, state_);
    chart_ = chart_prefix(chart_at_(in));
    torque_driven_chart_ = chart_prefix(torque_driven_chart_at_(in));
    in["g"] = {state_.p.x, state_.p.y, Exact::from_double(atan2(state_.R(1, 0), state_.R(0, 0)).to_double())};
    if (model_.group == GroupKind::SE2)
      state_.R = AxisRotation<Exact>{2, cos(in["g"][2]), sin(in["g"][2])}.matrix();
    for (const InputBlock& block : program_.inputs) {
      if (in.contains(block.name)) continue;
      for (std::size_t i = 0; i < block.nodes.size(); ++i)
        in[block.name].push_back(source.uniform(Exact(-1), Exact(1)));
    }
    if (is_exact) {
      make_compatible(in, exact_, in);
    } else {
      make_compatible(in, extended_, in_long_double(in));
    }
    return in;
  }

  /// Imposed rates that satisfy C r_a_dot = 0, C r_a_ddot + ... = 0 as well as doubles can.
  template <class S>
  void make_compatible(NamedValues<Exact>& in, const ProgramCaller<S>& call, NamedValues<S> in_digits) {
    const std::string compatibility = chart_ + "compatibility";
    if (find_function(program_, compatibility) == nullptr) return;
    for (const char* name : {"velocity_residual", "acceleration_residual"}) {
      const std::string input = std::string(name) == "velocity_residual" ? "r_a_dot" : "r_a_ddot";
      const std::vector<S> residual = call(compatibility, in_digits).at(name);
      residual_scale_[name] = size_of(residual);  // before its terms are made to cancel
      std::vector<S>& x = in_digits.at(input);
      Matrix<S> C(static_cast<int>(residual.size()), static_cast<int>(x.size()));
      for (std::size_t j = 0; j < x.size(); ++j) {  // linear in x: columns by unit steps
        const S kept = x[j];
        x[j] += S(1);
        const std::vector<S> column = call(compatibility, in_digits).at(name);
        for (std::size_t i = 0; i < residual.size(); ++i)
          C(static_cast<int>(i), static_cast<int>(j)) = column[i] - residual[i];
        x[j] = kept;
      }
      const std::vector<S> step = minimum_norm_solution(C, residual);
      for (std::size_t j = 0; j < x.size(); ++j) {
        in.at(input)[j] = rounded(x[j] - step[j]);
        if constexpr (std::is_same_v<S, Exact>) {
          x[j] = in.at(input)[j];
        } else {
          x[j] = in.at(input)[j].to_double();
        }
      }
    }
  }
  static Exact rounded(const Exact& x) { return Exact::from_double(x.to_double()); }
  static Exact rounded(long double x) { return Exact::from_double(static_cast<double>(x)); }

  static NamedValues<double> as_doubles(const NamedValues<Exact>& in) {
    NamedValues<double> out;
    for (const auto& [name, values] : in) {
      for (const Exact& x : values) out[name].push_back(x.to_double());
    }
    return out;
  }

  /// Functions of a chart are compared where it is the best. Quality alone is compared everywhere but where a
  /// chart divides by zero.
  [[nodiscard]] bool is_of_another_chart(const std::string& function) const {
    const std::size_t at = function.find("::");
    const std::string name = at == std::string::npos ? function : function.substr(at + 2);
    const std::string& best = name.starts_with("torque_driven_") ? torque_driven_chart_ : chart_;
    if (at != std::string::npos) return function.substr(0, at + 2) != best;
    return !best.empty() && find_function(program_, best + name) != nullptr;
  }

  /// Compiled code against a judge that is given the same inputs in its own numbers.
  template <class S>
  void compare(const NamedValues<Exact>& in, const ProgramCaller<S>& judge, const NamedValues<S>& for_judge) {
    const NamedValues<double> rounded = as_doubles(in);
    for (const Function& f : program_.functions) {
      if (is_of_another_chart(f.name)) continue;
      const NamedValues<S> expected = judge(f.name, for_judge);
      const NamedValues<double> got = compiled_(f.name, rounded);
      for (const OutputBlock& b : f.outputs) {
        OutputRecord& record = records_[{f.name, b.name}];
        record.error.push_back(distance(got.at(b.name), expected.at(b.name)));
        const double scale = size_of(expected.at(b.name));
        record.scale.push_back(f.name.ends_with("compatibility") ? std::max(scale, residual_scale_[b.name])
                                                                 : scale);
        record.sample.push_back(sample_);
        if (!(record.error.back() <= bound_ * record.scale.back()))  // may be asked for its condition
          inputs_of_sample_[sample_] = in;
      }
    }
  }

  /// The basis-free outputs by the exact recursion, at the velocities that nu and r_a_dot mean.
  void check_formulas(const Mechanism<Exact>& mechanism, const Mechanism<double>& rounded,
                      const NamedValues<Exact>& in) {
    const auto run = [&](const std::string& name, const NamedValues<Exact>& at) {
      const std::string of_chart = chart_ + name;
      return find_function(program_, of_chart) != nullptr ? exact_(of_chart, at) : NamedValues<Exact>{};
    };
    const NamedValues<Exact> kinematics = run("kinematics", in);
    EvaluationInput<Exact> input;
    input.state = state_;
    const auto block = [](const NamedValues<Exact>& values, const std::string& name, std::size_t size) {
      const auto found = values.find(name);
      return found == values.end() ? std::vector<Exact>(size, Exact(0)) : found->second;
    };
    const auto n = static_cast<std::size_t>(partition_.n);
    const auto components = free_components(model_.group);
    const std::vector<Exact> eta = block(kinematics, "eta", n);
    for (std::size_t i = 0; i < n; ++i) input.state.eta[components[i]] = eta[i];
    const std::vector<Exact> r_p_dot =
        block(kinematics, "r_p_dot", static_cast<std::size_t>(partition_.s_p()));
    for (std::size_t i = 0; i < r_p_dot.size(); ++i)
      input.state.r_dot[static_cast<std::size_t>(partition_.passive[n + i]) - n] = r_p_dot[i];
    std::vector<int> driven;  // joints that a scene drives by torque, behind the passive ones
    driven.assign(reduced_.passive.begin() + static_cast<std::ptrdiff_t>(partition_.passive.size()),
                  reduced_.passive.end());
    const std::vector<Exact> r_d_dot = block(kinematics, "r_d_dot", driven.size());
    const std::vector<Exact> torque = block(in, reduced_.active.empty() ? "tau_a" : "tau_d", driven.size());
    input.r_ddot.assign(model_.coordinates.size(), Exact(0));
    input.tau.assign(model_.coordinates.size(), Exact(0));
    for (std::size_t i = 0; i < driven.size(); ++i) {
      const std::size_t at = static_cast<std::size_t>(driven[i]) - n;
      input.state.r_dot[at] = r_d_dot[i];
      input.tau[at] = torque[i];
    }
    const std::vector<Exact> r_a_dot = block(in, "r_a_dot", reduced_.active.size());
    const std::vector<Exact> r_a_ddot = block(in, "r_a_ddot", reduced_.active.size());
    for (std::size_t i = 0; i < reduced_.active.size(); ++i) {
      const std::size_t at = static_cast<std::size_t>(reduced_.active[i]) - n;
      input.state.r_dot[at] = r_a_dot[i];
      input.r_ddot[at] = r_a_ddot[i];
    }
    input.has_acceleration = true;
    ++formula_count_;
    const ReductionReport& reduction = derivation_.reduction;
    const RowSharing sharing{reduction.inverse == Inverse::leading, reduction.ranks.leading_rows, {}};
    const Evaluated<Exact> expected =
        evaluate_recursion(mechanism, reduced_, input, Exact::from_decimal("1e-25"), sharing);
    const Evaluated<double> numeric =
        evaluate_recursion(rounded, reduced_, rounded_input<double>(input), 1e-9, sharing);

    NamedValues<Exact> at = in;
    const NamedValues<Exact> forward = run("forward_dynamics", at);
    if (forward.contains("nu_dot")) at["nu_dot"] = forward.at("nu_dot");
    if (at.contains("lambda_stat")) std::ranges::fill(at["lambda_stat"], Exact(0));
    const auto pick = [&](const auto& values, const std::vector<int>& indices) {
      std::decay_t<decltype(values)> r;
      for (const int i : indices) r.push_back(values[static_cast<std::size_t>(i)]);
      return r;
    };
    const auto agree = [&](const std::string& function, const std::string& output,
                           const std::vector<Exact>& got, const std::vector<Exact>& want,
                           const std::vector<double>& by_double) {
      const double scale = compare_formula(function, output, got, want);
      records_[{chart_ + function, output}].recursion_error.push_back(distance(by_double, want) / scale);
    };
    std::vector<int> eta_at(n), r_p_at(partition_.passive.begin() + partition_.n, partition_.passive.end());
    for (std::size_t i = 0; i < n; ++i) eta_at[i] = static_cast<int>(i);
    if (forward.contains("eta_dot"))
      agree("forward_dynamics", "eta_dot", forward.at("eta_dot"), pick(expected.acceleration, eta_at),
            pick(numeric.acceleration, eta_at));
    if (forward.contains("r_d_ddot"))
      agree("forward_dynamics", "r_d_ddot", forward.at("r_d_ddot"), pick(expected.acceleration, driven),
            pick(numeric.acceleration, driven));
    if (forward.contains("r_p_ddot"))
      agree("forward_dynamics", "r_p_ddot", forward.at("r_p_ddot"), pick(expected.acceleration, r_p_at),
            pick(numeric.acceleration, r_p_at));
    if (find_function(program_, chart_ + "inverse_torques") != nullptr)
      agree("inverse_torques", "tau_a", run("inverse_torques", at).at("tau_a"), expected.tau_a,
            numeric.tau_a);
    if (find_function(program_, chart_ + "multipliers") != nullptr)
      agree("multipliers", "lambda", run("multipliers", at).at("lambda"), expected.lambda, numeric.lambda);
    check_state_jacobian(in);
    balance_energy(mechanism, input, expected, at);
  }

  /// @return the scale of what was compared
  double compare_formula(const std::string& function, const std::string& output,
                         const std::vector<Exact>& got, const std::vector<Exact>& want) {
    const double scale = std::max(size_of(want), 1e-3);
    const double error = distance(got, want) / scale;
    if (error > formula_worst_) formula_worst_ = error, formula_at_ = function + "." + output;
    return scale;
  }

  /// state_jacobian against central differences of the velocities and accelerations of the exact program:
  /// with steps of 1e-20 these have an error of 1e-40, and 60 digits lose 20.
  void check_state_jacobian(const NamedValues<Exact>& in) {
    const std::string name = chart_ + "state_jacobian";
    if (find_function(program_, name) == nullptr) return;
    const WorkingDigits precision(2 * verification_digits);
    const Exact h = Exact::from_decimal("1e-20");
    const auto rates = [&](const NamedValues<Exact>& at) {
      std::vector<Exact> values;
      for (const auto& [function, blocks] :
           {std::pair{"kinematics", std::vector{"eta", "r_p_dot", "r_d_dot"}},
            std::pair{"forward_dynamics", std::vector{"nu_dot"}}}) {
        if (find_function(program_, chart_ + function) == nullptr) continue;
        const NamedValues<Exact> out = exact_(chart_ + function, at);
        for (const char* block : blocks) {
          const auto found = out.find(block);
          if (found != out.end()) values.insert(values.end(), found->second.begin(), found->second.end());
        }
      }
      return values;
    };
    const auto slope = [&](const std::function<void(NamedValues<Exact>&, const Exact&)>& move) {
      NamedValues<Exact> after = in, before = in;
      move(after, h), move(before, -h);
      std::vector<Exact> difference = rates(after);
      const std::vector<Exact> start = rates(before);
      for (std::size_t i = 0; i < start.size(); ++i)
        difference[i] = (difference[i] - start[i]) / (Exact(2) * h);
      return difference;
    };
    std::vector<std::vector<Exact>> columns;
    for (const int component : free_components(model_.group)) {
      columns.push_back(slope([&](NamedValues<Exact>& at, const Exact& step) {
        Vec3<Exact> V, Omega;
        (component < 3 ? V[component] : Omega[component - 3]) = step;
        const Vec3<Exact> moved = state_.R * V;
        if (model_.group == GroupKind::SE2) {
          at["g"][0] += moved.x, at["g"][1] += moved.y, at["g"][2] += Omega.z;
          return;
        }
        const Mat3<Exact> turned = state_.R + state_.R * skew(Omega);
        if (at.contains("R")) at["R"].assign(turned.m.begin(), turned.m.end());
        std::size_t next = 0;
        for (const int c : free_components(model_.group)) {
          if (c < 3) at["p"][next++] += moved[c];
        }
      }));
    }
    const auto add_block = [&](const std::string& block, std::size_t i) {
      columns.push_back(slope([&](NamedValues<Exact>& at, const Exact& step) { at.at(block)[i] += step; }));
    };
    const auto n = static_cast<std::size_t>(partition_.n);
    for (std::size_t i = 0; i + n < partition_.passive.size(); ++i) add_block("r_p", i);
    for (std::size_t i = partition_.passive.size(); i < reduced_.passive.size(); ++i) {  // torque-driven
      const auto at = std::ranges::find(partition_.active, reduced_.passive[i]);
      add_block("r_a", static_cast<std::size_t>(at - partition_.active.begin()));
    }
    for (std::size_t i = 0; in.contains("nu") && i < in.at("nu").size(); ++i) add_block("nu", i);
    const std::vector<Exact> by_time = slope([&](NamedValues<Exact>& at, const Exact& step) {
      at["t"][0] += step;
      for (std::size_t i = 0; i < reduced_.active.size(); ++i) {
        const auto place = std::ranges::find(partition_.active, reduced_.active[i]);
        at["r_a"][static_cast<std::size_t>(place - partition_.active.begin())] += step * in.at("r_a_dot")[i];
        at["r_a_dot"][i] += step * in.at("r_a_ddot")[i];
        at["r_a_ddot"][i] += step * in.at("r_a_dddot")[i];
      }
    });
    std::vector<Exact> by_state;  // row-major
    for (std::size_t row = 0; row < by_time.size(); ++row) {
      for (const auto& column : columns) by_state.push_back(column[row]);
    }
    const NamedValues<Exact> got = exact_(name, in);
    compare_formula("state_jacobian", "rates_x", got.at("rates_x"), by_state);
    compare_formula("state_jacobian", "rates_t", got.at("rates_t"), by_time);
  }

  /// d(T + V_gravity)/dt = tau_a . r_a_dot + power of what is applied; the derivative by central differences,
  /// whose error of 1e-24 is far below double rounding. Torques are those of the compiled code.
  void balance_energy(const Mechanism<Exact>& mechanism, const EvaluationInput<Exact>& input,
                      const Evaluated<Exact>& e, const NamedValues<Exact>& at) {
    Mechanism<Exact> bare = mechanism;
    bare.generalised_forces = {};
    bare.wrenches.clear();
    FreeDynamics<Exact> dynamics(bare);
    const Exact h = Exact::from_decimal("1e-12");
    const auto energy = [&](const Exact& step) {
      State<Exact> s = input.state;
      s.p += s.R * (step * s.eta.linear);
      s.R = s.R + step * (s.R * skew(s.eta.angular));
      const auto components = free_components(model_.group);
      for (std::size_t i = 0; i < components.size(); ++i) s.eta[components[i]] += step * e.acceleration[i];
      for (std::size_t i = 0; i < s.r.size(); ++i) {
        s.r[i] += step * input.state.r_dot[i];
        s.r_dot[i] += step * e.acceleration[components.size() + i];
      }
      return dynamics.energies(s);
    };
    const auto after = energy(h), before = energy(-h);
    const double rate_of_gravity = ((after.gravity - before.gravity) / (Exact(2) * h)).to_double();
    const double rate = ((after.kinetic - before.kinetic) / (Exact(2) * h)).to_double() + rate_of_gravity;
    const std::vector<Exact> inertial = dynamics.forces(input.state);
    double power = 0, scale = std::max(std::abs(rate), std::abs(rate_of_gravity));  // gravity is power too
    const auto add = [&](double x) { power += x, scale = std::max(scale, std::abs(x)); };
    const auto components = free_components(model_.group);
    for (std::size_t i = 0; i < inertial.size(); ++i) {
      const Exact& v =
          i < components.size() ? input.state.eta[components[i]] : input.state.r_dot[i - components.size()];
      add(((e.force[i] - inertial[i]) * v).to_double());
    }
    for (std::size_t i = 0; i < input.tau.size(); ++i) add((input.tau[i] * input.state.r_dot[i]).to_double());
    if (find_function(program_, chart_ + "inverse_torques") != nullptr) {
      const std::vector<double> tau = compiled_(chart_ + "inverse_torques", as_doubles(at)).at("tau_a");
      for (std::size_t i = 0; i < tau.size(); ++i) add(tau[i] * at.at("r_a_dot")[i].to_double());
    }
    if (scale > 0) energy_balance_ = std::max(energy_balance_, std::abs(rate - power) / scale);
  }

  /// Of an output with respect to the inputs of its function; where these alone don't explain the error, the
  /// parameters, which are inputs of generated code as well, are moved too.
  double condition(const std::string& function, const std::string& output, int sample, double scale,
                   double error) {
    const NamedValues<Exact>& in = inputs_of_sample_.at(sample);
    const double kappa = relative_condition(
        [&](const NamedValues<Exact>& at) { return exact_(function, at).at(output); }, in, scale);
    if (error <= allowed(kappa)) return kappa;
    const auto with_parameters = [&](const NamedValues<Exact>& at) {
      return interpreting_caller<Exact>(program_, at.at("parameters"))(function, in).at(output);
    };
    return kappa + relative_condition(with_parameters, {{"parameters", parameters_}}, scale);
  }

  double estimated_condition(const OutputBlock& block, int sample, double scale) const {
    const std::vector<double> state =
        flat_inputs(program_, double_parameters_, as_doubles(inputs_of_sample_.at(sample)));
    return first_order_condition(program_.tape, block, state, scale);
  }

  Verification summarise(int samples) {
    Verification v;
    v.samples = samples;
    v.formula_samples = formula_count_;
    v.formula_worst = formula_worst_;
    v.formula_at = formula_at_;
    v.energy_balance = energy_balance_;
    for (const Function& f : program_.functions) {
      for (const OutputBlock& b : f.outputs) {
        if (!records_.contains({f.name, b.name})) continue;  // of a chart that was never the best
        const ConditionAt condition_at = {
            [&](int sample, double scale) { return estimated_condition(b, sample, scale); },
            [&](int sample, double scale, double error) {
              return condition(f.name, b.name, sample, scale, error);
            }};
        OutputError e = judged(records_.at({f.name, b.name}), bound_, condition_at);
        e.function = f.name;
        e.output = b.name;
        v.passed = v.passed && e.passed;
        v.outputs.push_back(std::move(e));
      }
    }
    v.passed = v.passed && v.formula_worst <= formula_bound && v.energy_balance <= 1e-11;
    return v;
  }

  const Model& model_;
  const Program& program_;
  const Derivation& derivation_;
  Partition partition_, reduced_;  // all active joints apart; torque-driven ones with the passive
  MechanismDescription description_;
  std::vector<Exact> parameters_;
  std::vector<double> double_parameters_;
  ProgramCaller<Exact> exact_;
  ProgramCaller<long double> extended_;
  ProgramCaller<double> compiled_;
  State<Exact> state_;
  ChartFinder<Exact> chart_at_, torque_driven_chart_at_;
  std::string chart_, torque_driven_chart_;  // prefixes of the functions of the best chart at the state
  int sample_ = 0;
  double bound_ = 0;
  std::map<std::string, double>
      residual_scale_;  // natural scale of the compatibility residuals, which vanish
  std::map<std::pair<std::string, std::string>, OutputRecord> records_;
  std::map<int, NamedValues<Exact>> inputs_of_sample_;
  double formula_worst_ = 0, energy_balance_ = 0;
  int formula_count_ = 0;
  std::string formula_at_;
};

}  // namespace

Verification verify_program(const Model& model, const Derivation& derivation, const VerificationPlan& plan,
                            const std::function<void(int)>& progress) {
  return Verifier(model, derivation).run(plan, progress);
}

}  // namespace anholon
