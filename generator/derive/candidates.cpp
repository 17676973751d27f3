// SPDX-License-Identifier: GPL-2.0-or-later
// A function comes by several routes; the cheapest that keeps enough digits is kept.
#include <algorithm>
#include <numeric>

#include "algebra/closed_form.hpp"
#include "anholon/charts.hpp"
#include "derive/deriver.hpp"
#include "optimise/accuracy/rounded.hpp"
#include "optimise/tape/passes.hpp"

namespace anholon {

OutputBlock Deriver::block(std::string name, std::string unit, std::string meaning, const Matrix<Expr>& m) {
  OutputBlock b{std::move(name), std::move(unit), std::move(meaning), m.rows(), m.cols(), {}};
  for (const Expr& e : m.entries()) b.nodes.push_back(e.id(tape_));
  return b;
}

OutputBlock Deriver::block(std::string name, std::string unit, std::string meaning,
                           const std::vector<Expr>& v) {
  OutputBlock b{std::move(name), std::move(unit), std::move(meaning), static_cast<int>(v.size()), 1, {}};
  for (const Expr& e : v) b.nodes.push_back(e.id(tape_));
  return b;
}

void Deriver::emit(const std::string& name, const std::string& meaning, std::vector<Route> routes,
                   const std::string& remark, bool simplified,
                   const std::function<std::vector<Route>()>& accurate) {
  const auto without_empty_blocks = [](Route r) {
    std::erase_if(r.outputs, [](const OutputBlock& b) { return b.nodes.empty(); });
    return r;
  };
  for (Route& r : routes) r = without_empty_blocks(std::move(r));
  std::erase_if(routes, [](const Route& r) { return r.outputs.empty(); });
  if (routes.empty()) return;
  std::vector<Candidate> candidates;
  const auto add = [&](const std::string& route, std::vector<OutputBlock> outputs) {
    const int operations = operations_per_call(program_, roots_of(outputs)).total();
    candidates.push_back({route, std::move(outputs), operations, candidates.size()});
  };
  for (Route& r : routes) add(r.name, std::move(r.outputs));
  if (request_.closed_forms && simplified && request_.optimise != OptimiseFor::nothing) {
    const std::vector<OutputBlock> base =
        std::ranges::min_element(candidates, {}, &Candidate::operations)->outputs;
    if (const auto closed = closed_form(tape_, roots_of(base))) add("closed form", with_roots(base, *closed));
  }
  if (request_.optimise == OptimiseFor::speed) add_after_passes(candidates);
  const auto states = [this](int count) { return states_of(atlas_, chart_, count); };
  const std::size_t best =
      choose(tape_, candidates, request_.optimise, states, [&](const MeasuredStates& at) {
        if (accurate) {
          for (const Route& r : accurate()) add(r.name, without_empty_blocks(r).outputs);
        }
        add_stable_forms(candidates);
        std::vector<std::size_t> formulations(candidates.size());
        std::iota(formulations.begin(), formulations.end(), std::size_t{0});
        if (request_.optimise == OptimiseFor::accuracy) add_after_passes(candidates);
        add_compensated(tape_, candidates, parameter_nodes_, request_.optimise, at, formulations);
      });
  const std::string full_name = prefix_ + name;
  const std::size_t first_report = result_->candidates.size();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    result_->candidates.push_back({full_name, c.name, c.operations, i == best, c.error});
  }
  const std::string route = "route: " + candidates[best].name;
  program_.functions.push_back(
      {full_name, meaning, candidates[best].outputs, remark.empty() ? route : remark + "; " + route});
  if (request_.trace)
    traced_.push_back({full_name, std::move(candidates), best, first_report, atlas_, chart_});
}

void Deriver::add_stable_forms(std::vector<Candidate>& candidates) {
  const std::size_t routes = candidates.size();
  for (std::size_t i = 0; i < routes; ++i) {
    if (auto stable = in_stable_form(tape_, candidates[i], parameter_nodes_))
      candidates.push_back(std::move(*stable));
  }
}

void Deriver::add_after_passes(std::vector<Candidate>& candidates) {
  const std::size_t routes = candidates.size();
  for (std::size_t i = 0; i < routes; ++i) {
    for (Candidate& c : after_passes(tape_, candidates[i], parameter_nodes_))
      candidates.push_back(std::move(c));
  }
}

std::vector<std::vector<double>> Deriver::states_of(const KernelAtlas* atlas, std::size_t chart, int count) {
  const std::size_t charts = atlas == nullptr ? 1 : atlas->charts.size();
  const int times = static_cast<int>(std::min<std::size_t>(charts, 8));
  std::vector<std::vector<double>> states = sampled_inputs_(program_, count * times);
  if (charts < 2) return states;
  std::vector<NodeId> quality;
  for (const Expr& e : atlas->quality) quality.push_back(e.id(tape_));
  ReproducibleInterpreter qualities(tape_, quality);
  std::erase_if(states, [&](const std::vector<double>& inputs) {
    return best_chart(std::span<const double>(qualities(inputs))) != chart;
  });
  if (states.size() > static_cast<std::size_t>(count)) states.resize(static_cast<std::size_t>(count));
  return states;
}

void Deriver::trace() {
  for (Traced& t : traced_) {
    Candidate route = t.candidates[t.candidates[t.best].route];
    route.name = "as derived";
    std::vector<Candidate> steps = {route};
    route.name.clear();
    if (auto stable = in_stable_form(tape_, route, parameter_nodes_)) steps.push_back(std::move(*stable));
    for (const AfterPass& step : run_passes(tape_, roots_of(route.outputs), parameter_nodes_))
      steps.push_back({step.pass, with_roots(route.outputs, step.roots), step.operations});
    const MeasuredStates at{states_of(t.atlas, t.chart, measured_states), {}, {}};
    for (Candidate& c : t.candidates) c.error = {};
    measure(tape_, t.candidates, at);
    measure(tape_, steps, at);
    for (std::size_t i = 0; i < t.candidates.size(); ++i)
      result_->candidates[t.first_report + i].error = t.candidates[i].error;
    for (const Candidate& c : steps) result_->trace.push_back({t.function, c.name, c.operations, c.error});
  }
}

}  // namespace anholon
