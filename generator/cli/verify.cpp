// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/verify.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "check/error_measure.hpp"
#include "check/verify_tree.hpp"
#include "cli/common.hpp"

namespace anholon::cli {
namespace {

constexpr double ulp = 2.220446049250313e-16;

std::string json_text(const Model& model, const Verification& v, double bound) {
  nlohmann::ordered_json j;
  j["schema"] = "anholon.verify/1";
  j["model"] = model.name;
  j["samples"] = v.samples;
  j["bound"] = bound;
  j["energy_balance"] = v.energy_balance;
  j["formulas"] = {{"samples", v.formula_samples}, {"worst", v.formula_worst}, {"at", v.formula_at}};
  for (const OutputError& e : v.outputs) {
    nlohmann::ordered_json entry = {{"function", e.function}, {"output", e.output}, {"median", e.median},
                                    {"p99", e.p99},           {"worst", e.worst},   {"worst_at", e.worst_at},
                                    {"passed", e.passed}};
    if (e.condition > 0) entry["condition"] = e.condition;
    if (!e.passed) entry["failed_at"] = e.failed_at;
    if (e.recursion_worst >= 0) entry["recursion_worst"] = e.recursion_worst;
    j["outputs"].push_back(std::move(entry));
  }
  j["passed"] = v.passed;
  return j.dump(1) + "\n";
}

}  // namespace

int verify(const VerifyOptions& options) {
  const Stopwatch watch;
  const Model model = load_model(options);
  AnyDerivation derivation = derive_any(options, model);
  if (derivation.reduction && !options.functions.empty()) {
    // Torques and multipliers are compared at the velocities and accelerations that these give, and power
    // balances between them.
    VerifyOptions complete = options;
    for (const char* name :
         {"kinematics", "compatibility", "forward_dynamics", "inverse_torques", "energies"}) {
      if (std::ranges::find(complete.functions, name) == complete.functions.end())
        complete.functions.emplace_back(name);
    }
    derivation = derive_any(complete, model);
  }
  const VerificationPlan plan{options.samples, options.bound_ulps * ulp};
  double shown = 1;
  const auto progress = [&](int done) {
    if (watch.seconds() < shown || isatty(STDERR_FILENO) == 0) return;
    fmt::print(stderr, "\r{} of {} samples", done, options.samples);
    std::fflush(stderr);
    shown = watch.seconds() + 0.5;
  };
  const Verification v = derivation.tree ? verify_tree(model, *derivation.tree, plan, progress)
                                         : verify_program(model, *derivation.reduction, plan, progress);
  if (shown > 1 && isatty(STDERR_FILENO) != 0) fmt::print(stderr, "\r{:40s}\r", "");
  if (options.json) {
    fmt::print("{}", json_text(model, v, plan.bound));
    return v.passed ? ok : check_failed;
  }
  fmt::print("{}: generated code against exact evaluation at {} random states of the working range\n",
             model.name, v.samples);
  if (v.samples > exactly_judged)
    fmt::print("exact at the first {}, in long double at the others\n", exactly_judged);
  fmt::print(
      "error relative to the natural scale of the output, in ulps of it (2^-52); bound {:.0e} = {:.0f} ulps, "
      "beyond it 10 eps kappa\n\n",
      plan.bound, options.bound_ulps);
  fmt::print("{:26s} {:22s} {:>8s} {:>8s} {:>8s} {:>9s} {:>10s}  {}\n", "function", "output", "median",
             "99 %", "worst", "relative", "recursion", "worst at");
  for (const OutputError& e : v.outputs) {
    fmt::print("{:26s} {:22s} {:>8.2f} {:>8.2f} {:>8.2f} {:>9.1e} {:>10s}  {}{}{}\n", e.function, e.output,
               e.median / ulp, e.p99 / ulp, e.worst / ulp, e.worst,
               e.recursion_worst < 0 ? "" : fmt::format("{:.1e}", e.recursion_worst),
               e.worst > 0 ? e.worst_at : "",
               e.condition > 0 ? fmt::format(", kappa {:.1e}", e.condition) : "",
               e.passed ? "" : "  FAILED at " + e.failed_at);
  }
  fmt::print(
      "\nformulas: the program and the numeric recursion, both exact, differ by {:.1e} at most ({} "
      "states{})\n",
      v.formula_worst, v.formula_samples, v.formula_at.empty() ? "" : ", " + v.formula_at);
  fmt::print("energy balance: |dE/dt - power| at most {:.1e} of the largest power\n", v.energy_balance);
  fmt::print("{}\n", v.passed ? "passed" : "FAILED");
  return v.passed ? ok : check_failed;
}

}  // namespace anholon::cli
