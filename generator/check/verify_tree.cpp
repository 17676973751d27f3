// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/verify_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <span>

#include "anholon/free_dynamics.hpp"
#include "check/compiled_caller.hpp"
#include "check/error_measure.hpp"
#include "check/output_record.hpp"
#include "check/relative_condition.hpp"
#include "check/tree_reference.hpp"
#include "derive/tree_functions.hpp"
#include "describe/mechanise.hpp"
#include "optimise/accuracy/rounding_shares.hpp"
#include "reduce/samples.hpp"

namespace anholon {
namespace {

/// A rotation near R, by Gram-Schmidt in working precision.
Mat3<Exact> nearest_rotation(const Mat3<Exact>& R) {
  const auto column = [&](int j) { return Vec3<Exact>{R(0, j), R(1, j), R(2, j)}; };
  const auto scaled = [](const Vec3<Exact>& v) { return (Exact(1) / sqrt(dot(v, v))) * v; };
  const Vec3<Exact> x = scaled(column(0));
  const Vec3<Exact> y = scaled(column(1) - dot(x, column(1)) * x);
  const Vec3<Exact> z = cross(x, y);
  return {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
}

/// States at which the exact recursion runs: its unit sweeps grow with the square of the size.
int formula_samples_of(int size) { return std::clamp(400 / std::max(size, 1), 5, 40); }

TreePoint<double> rounded(const TreePoint<Exact>& x) {
  const auto all = [](const std::vector<Exact>& from) {
    std::vector<double> to;
    for (const Exact& e : from) to.push_back(e.to_double());
    return to;
  };
  TreePoint<double> r;
  for (std::size_t i = 0; i < 9; ++i) r.state.R.m[i] = x.state.R.m[i].to_double();
  for (int i = 0; i < 3; ++i) r.state.p[i] = x.state.p[i].to_double();
  for (int i = 0; i < 6; ++i) {
    r.state.eta[i] = x.state.eta[i].to_double();
    r.eta_dot[i] = x.eta_dot[i].to_double();
  }
  r.state.r = all(x.state.r), r.state.r_dot = all(x.state.r_dot);
  r.r_ddot = all(x.r_ddot), r.tau = all(x.tau);
  return r;
}

class TreeVerifier {
 public:
  TreeVerifier(const Model& model, const Program& program)
      : model_(model), program_(program), components_(free_components(model.group)) {
    const MechanismDescription description = describe_mechanism(model);
    std::vector<Exact> parameters;
    for (const Parameter& p : model.parameters) {
      parameters_.push_back(p.value.to_double());  // double code is given these numbers
      parameters.push_back(Exact::from_double(parameters_.back()));
    }
    mechanism_ = mechanise<Exact>(description, parameters);
    in_double_ = mechanise<double>(description, parameters_);
    exact_ = interpreting_caller<Exact>(program, parameters);
    extended_ = interpreting_caller<long double>(program, {parameters_.begin(), parameters_.end()});
    compiled_ = compiled_caller(program, parameters);
    for (const Function& f : program.functions) {  // others are steps of these
      if (std::ranges::find(tree_function_names(), f.name) != tree_function_names().end())
        checked_.emplace_back(f);
    }
  }

  Verification run(const VerificationPlan& plan, const std::function<void(int)>& progress) {
    bound_ = plan.bound;
    const int size = static_cast<int>(components_.size()) + mechanism_.coordinates;
    SampleSource source(4);
    for (int s = 0; s < plan.samples; ++s) {
      if (progress) progress(s);
      const TreePoint<Exact> x = random_point(source);
      const NamedValues<Exact> in = tree_inputs(mechanism_, x);
      if (s < exactly_judged) {
        compare(s + 1, x, exact_, in);
      } else {
        compare(s + 1, x, extended_, in_long_double(in));
      }
      if (s < formula_samples_of(size)) check_formulas(x);
    }
    return summarise(plan.samples);
  }

 private:
  /// Position in the working range; velocities, accelerations and forces in +-1. Every value is a double.
  TreePoint<Exact> random_point(SampleSource& source) const {
    const auto unit = [&] { return source.uniform(Exact(-1), Exact(1)); };
    TreePoint<Exact> x;
    x.state = random_state(model_, source);
    for (const int c : components_) x.eta_dot[c] = unit();
    for (int i = 0; i < mechanism_.coordinates; ++i) {
      x.r_ddot.push_back(unit());
      x.tau.push_back(unit());
    }
    return x;
  }

  /// Compiled code against a judge that is given the same inputs in its own numbers.
  template <class S>
  void compare(int sample, const TreePoint<Exact>& x, const ProgramCaller<S>& judge,
               const NamedValues<S>& for_judge) {
    const NamedValues<double> in_double = tree_inputs(in_double_, rounded(x));
    for (const Function& f : checked_) {
      const NamedValues<S> expected = judge(f.name, for_judge);
      const NamedValues<double> got = compiled_(f.name, in_double);
      for (const OutputBlock& b : f.outputs) {
        OutputRecord& record = records_[{f.name, b.name}];
        record.error.push_back(distance(got.at(b.name), expected.at(b.name)));
        record.scale.push_back(size_of(expected.at(b.name)));
        record.sample.push_back(sample);
        if (!(record.error.back() <= bound_ * record.scale.back()))  // may be asked for its condition
          points_.insert_or_assign(sample, x);
      }
    }
  }

  void check_formulas(const TreePoint<Exact>& at) {
    TreePoint<Exact> x = at;  // formulas that agree for rotations differ for matrices rounded to double
    x.state.R = nearest_rotation(at.state.R);
    ++formula_count_;
    const NamedValues<Exact> in = tree_inputs(mechanism_, x);
    for (const Function& f : checked_) {
      const NamedValues<Exact> expected = tree_reference(mechanism_, f.name, x);
      const NamedValues<double> numeric = tree_reference(in_double_, f.name, rounded(x));
      const NamedValues<Exact> got = exact_(f.name, in);
      for (const OutputBlock& b : f.outputs) {
        const std::vector<Exact>& want = expected.at(b.name);
        const double scale = std::max(size_of(want), 1e-3);
        const double error = distance(got.at(b.name), want) / scale;
        if (!(error <= formula_worst_)) formula_worst_ = error, formula_at_ = f.name + "." + b.name;
        records_[{f.name, b.name}].recursion_error.push_back(distance(numeric.at(b.name), want) / scale);
      }
    }
    balance_energy(x);
  }

  /// d(T + V)/dt = power of wrench, joint forces and what the joints resist with; the forces are those of
  /// the compiled inverse dynamics, the derivative is by central differences with an error of 1e-24.
  void balance_energy(const TreePoint<Exact>& x) {
    if (find_function(program_, "inverse_dynamics") == nullptr) return;
    Mechanism<Exact> bare = mechanism_;
    bare.generalised_forces = {};
    FreeDynamics<Exact> inertial(bare), dynamics(mechanism_);
    const Exact h = Exact::from_decimal("1e-12");
    const auto energy = [&](const Exact& step) {
      State<Exact> s = x.state;
      s.p += s.R * (step * s.eta.linear);
      s.R = s.R + step * (s.R * skew(s.eta.angular));
      for (const int c : components_) s.eta[c] += step * x.eta_dot[c];
      for (std::size_t i = 0; i < s.r.size(); ++i) {
        s.r[i] += step * x.state.r_dot[i];
        s.r_dot[i] += step * x.r_ddot[i];
      }
      const auto e = inertial.energies(s);
      return e.kinetic + e.gravity;
    };
    const double rate = ((energy(h) - energy(-h)) / (Exact(2) * h)).to_double();
    const std::vector<Exact> with = dynamics.forces(x.state), without = inertial.forces(x.state);
    const NamedValues<double> got = compiled_("inverse_dynamics", tree_inputs(in_double_, rounded(x)));
    double power = 0, scale = std::abs(rate);
    const auto add = [&](double term) { power += term, scale = std::max(scale, std::abs(term)); };
    const std::size_t n = components_.size();
    for (std::size_t i = 0; i < with.size(); ++i) {
      const Exact& v = i < n ? x.state.eta[components_[i]] : x.state.r_dot[i - n];
      add(((with[i] - without[i]) * v).to_double());
      add((i < n ? got.at("base_wrench")[i] : got.at("tau")[i - n]) * v.to_double());
    }
    if (scale > 0) energy_balance_ = std::max(energy_balance_, std::abs(rate - power) / scale);
  }

  double condition(const std::string& function, const std::string& output, int sample, double scale) {
    const NamedValues<Exact> in = tree_inputs(mechanism_, points_.at(sample));
    return relative_condition([&](const NamedValues<Exact>& at) { return exact_(function, at).at(output); },
                              in, scale);
  }

  double estimated_condition(const OutputBlock& block, int sample, double scale) const {
    const NamedValues<double> in = tree_inputs(in_double_, rounded(points_.at(sample)));
    return first_order_condition(program_.tape, block, flat_inputs(program_, parameters_, in), scale);
  }

  Verification summarise(int samples) {
    Verification v;
    v.samples = samples;
    v.formula_samples = formula_count_;
    v.formula_worst = formula_worst_;
    v.formula_at = formula_at_;
    v.energy_balance = energy_balance_;
    for (const Function& f : checked_) {
      for (const OutputBlock& b : f.outputs) {
        const ConditionAt condition_at = {
            [&](int sample, double scale) { return estimated_condition(b, sample, scale); },
            [&](int sample, double scale, double) { return condition(f.name, b.name, sample, scale); }};
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

  const WorkingDigits precision_{verification_digits};
  const Model& model_;
  const Program& program_;
  std::vector<std::reference_wrapper<const Function>> checked_;  // functions that have a reference
  std::span<const int> components_;
  std::vector<double> parameters_;
  Mechanism<Exact> mechanism_;
  Mechanism<double> in_double_;
  ProgramCaller<Exact> exact_;
  ProgramCaller<long double> extended_;
  ProgramCaller<double> compiled_;
  std::map<int, TreePoint<Exact>> points_;  // those whose condition may be asked for
  std::map<std::pair<std::string, std::string>, OutputRecord> records_;
  double bound_ = 0, formula_worst_ = 0, energy_balance_ = 0;
  int formula_count_ = 0;
  std::string formula_at_;
};

}  // namespace

Verification verify_tree(const Model& model, const TreeDerivation& derivation, const VerificationPlan& plan,
                         const std::function<void(int)>& progress) {
  return TreeVerifier(model, derivation.program).run(plan, progress);
}

}  // namespace anholon
