// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/tree_functions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "derive/loop_tables.hpp"
#include "derive/sampled_inputs.hpp"
#include "derive/tree_quantities.hpp"
#include "optimise/accuracy/variants.hpp"
#include "optimise/model/align_parallel.hpp"
#include "optimise/model/regroup.hpp"
#include "optimise/model/rotate_leaves.hpp"
#include "optimise/model/slide_frames.hpp"
#include "optimise/tape/count.hpp"
#include "optimise/tape/hoist.hpp"
#include "optimise/tape/passes.hpp"
#include "optimise/tree_loops.hpp"

namespace anholon {
namespace {

/// One choice of frames and inertial figures: the same motion, other constants.
struct Frames {
  std::string name;
  Mechanism<Expr> mechanism;
};

/// What became of a function, for the trace.
struct Kept {
  TreeRoute algorithm;
  std::vector<Candidate> candidates;
  std::vector<Candidate> passes;  // on the program; the first is what they were given
  std::size_t first_report = 0;   // of the candidates
};

class TreeDeriver {
 public:
  TreeDeriver(const Model& model, const TreeRequest& request)
      : model_(model),
        request_(request),
        result_(std::make_unique<TreeDerivation>()),
        program_(result_->program),
        tape_(program_.tape),
        quantities_(model, program_),
        sampled_inputs_(model) {
    for (const ParameterInfo& p : program_.parameters) parameters_.push_back(p.node);
  }

  std::unique_ptr<TreeDerivation> run() {
    begin_program(program_, model_, request_.scene, request_.functions, tree_function_names());
    if (request_.optimise != OptimiseFor::balanced)
      program_.notes.push_back(fmt::format("optimised for {}", anholon::name(request_.optimise)));
    make_frames();
    for (const std::string& name : tree_function_names()) {
      const std::vector<std::string>& wanted =
          request_.functions.empty() ? standard_tree_functions() : request_.functions;
      if (std::ranges::find(wanted, name) != wanted.end()) derive(name);
    }
    if (program_.functions.empty())
      throw UnsupportedError(fmt::format(
          "robot '{}' has nothing that moves and so none of these functions; give it a joint, or a "
          "free base (--floating)",
          model_.name));
    if (request_.trace) trace_passes();  // last: it leaves nodes on the tape, which no function needs
    return std::move(result_);
  }

 private:
  // ---- frames
  // --------------------------------------------------------------------------------------------------
  void make_frames() {
    Mechanism<Expr> mechanism = quantities_.merged();
    result_->passes.push_back(fmt::format("merged {} bodies on fixed joints", quantities_.merged_bodies()));
    result_->passes.push_back(fmt::format("aligned {} frames with parallel ones", align_parallel(mechanism)));
    if (request_.trace) trace_frames();
    const auto add = [&](const std::string& name, Mechanism<Expr> m, bool tips, bool base_parameters) {
      if (tips) rotate_leaves(m);
      if (base_parameters) regroup(m);
      frames_.push_back({name, std::move(m)});
    };
    Mechanism<Expr> to_tips = mechanism;
    result_->passes.push_back(fmt::format("slid {} frames along their joints", slide_frames(to_tips)));
    add("slid to the tips, tips turned, regrouped", to_tips, true, true);
    if (!request_.search || request_.optimise == OptimiseFor::nothing) return;
    Mechanism<Expr> to_base = mechanism;
    slide_frames(to_base, SlideTowards::base);
    add("slid to the base, tips turned, regrouped", to_base, true, true);
    add("slid to the tips, regrouped", to_tips, false, true);
    add("slid to the base, regrouped", to_base, false, true);
    add("slid to the tips", to_tips, false, false);
  }

  /// The passes on the mechanism one by one, as the first choice of frames has them.
  void trace_frames() {
    stages_.push_back({"as described", quantities_.described()});
    Mechanism<Expr> m = quantities_.merged();
    const auto stage = [&](const std::string& name) { stages_.push_back({name, m}); };
    stage("fixed joints merged");
    align_parallel(m);
    stage("parallel frames aligned");
    slide_frames(m);
    stage("frames slid");
    rotate_leaves(m);
    stage("tips turned");
    regroup(m);
    stage("inertia regrouped");
  }

  void trace_passes() {
    for (const Function& f : program_.functions) {
      if (f.loops) {
        result_->trace.push_back({f.name, loops_route, operations_per_call(program_, f).total()});
        continue;
      }
      Kept& kept = kept_.at(f.name);
      std::vector<Candidate> passes;
      for (const Frames& stage : stages_) {
        if (!kept.algorithm.depends_on_frames) break;
        std::vector<OutputBlock> outputs = kept.algorithm.outputs(stage.mechanism);
        std::erase_if(outputs, [](const OutputBlock& b) { return b.nodes.empty(); });
        if (outputs.empty()) continue;
        const int operations = cost_of(outputs);
        passes.push_back({stage.name, std::move(outputs), operations});
      }
      passes.insert(passes.end(), kept.passes.begin(), kept.passes.end());
      measure(tape_, passes, {states(), {}, {}});
      for (Candidate& c : kept.candidates) c.error = {};
      measure(tape_, kept.candidates, {states(), {}, {}});
      for (const Candidate& c : passes) result_->trace.push_back({f.name, c.name, c.operations, c.error});
      for (std::size_t i = 0; i < kept.candidates.size(); ++i)
        result_->candidates[kept.first_report + i].error = kept.candidates[i].error;
    }
  }

  [[nodiscard]] std::vector<std::vector<double>> states(int count = measured_states) {
    return sampled_inputs_(program_, count);
  }

  // ---- routes
  // --------------------------------------------------------------------------------------------------
  /// Loops whose straight line would take more operations than that are kept as loops: compilers take long
  /// over such functions, and the instructions no longer fit the caches.
  static constexpr int longest_straight_line = 6000;
  static constexpr const char* loops_route = "loops over the tree";

  /// Derives a function that is emitted as loops, and the one that they start from.
  /// @return false where a straight line does
  bool derive_loops(const std::string& name) {
    if (!has_loops(name)) return false;
    RigidTree<Expr> tree(name == "regressor" ? quantities_.merged() : frames_[0].mechanism);
    tree.position(quantities_.inputs().r);
    const std::optional<TreeLoops> loops = tree_loops(name, tree);
    if (!loops || count_operations(*loops).total() <= longest_straight_line) return false;
    if (std::ranges::find(program_.functions, loops->from, &Function::name) == program_.functions.end())
      derive(loops->from);
    Function f{name, quantities_.meaning(name), {}, fmt::format("route: {}", loops_route), loops};
    std::vector<std::vector<Expr>> from;
    for (const OutputBlock& b : straight_line(program_, f).outputs) {
      from.emplace_back();
      for (const NodeId id : b.nodes) from.back().emplace_back(tape_, id);
    }
    const std::vector<std::vector<Expr>> values = values_of(*loops, from);
    f.outputs = quantities_.blocks_of(name, values);
    program_.functions.push_back(std::move(f));
    result_->candidates.push_back(
        {name, loops_route, operations_per_call(program_, program_.functions.back()).total(), true});
    return true;
  }

  /// Derives a function by every route and keeps the cheapest.
  void derive(const std::string& name) {
    if (std::ranges::find(program_.functions, name, &Function::name) != program_.functions.end()) return;
    if (derive_loops(name)) return;
    std::vector<Candidate> candidates;
    std::vector<TreeRoute> algorithms;
    std::set<std::string> hopeless;  // algorithms that lost by a quarter in the first frames
    for (const Frames& frames : frames_) {
      const std::size_t first = candidates.size();
      for (const TreeRoute& algorithm : quantities_.routes(name)) {
        if (hopeless.contains(algorithm.name)) continue;
        if (!algorithm.depends_on_frames && &frames != &frames_[0]) continue;
        std::vector<OutputBlock> outputs = outputs_of(name, algorithm, frames.mechanism);
        std::erase_if(outputs, [](const OutputBlock& b) { return b.nodes.empty(); });
        if (outputs.empty()) continue;
        const int operations = cost_of(outputs);
        candidates.push_back({algorithm.name, std::move(outputs), operations, candidates.size()});
        algorithms.push_back(algorithm);
      }
      if (first == candidates.size()) continue;
      int least = candidates[first].operations;
      for (std::size_t i = first; i < candidates.size(); ++i)
        least = std::min(least, candidates[i].operations);
      for (std::size_t i = first; i < candidates.size(); ++i) {
        Candidate& c = candidates[i];
        if (c.operations > least + least / 4 && request_.optimise != OptimiseFor::accuracy)
          hopeless.insert(c.name);
        c.name += (c.name.empty() ? "frames " : ", frames ") + frames.name;
      }
    }
    if (candidates.empty()) return;
    const std::vector<Candidate> derived = candidates;
    std::vector<std::size_t> order = by_operations(derived);
    order.resize(request_.optimise == OptimiseFor::nothing ? 0 : std::min(order.size(), finalists));
    std::vector<std::vector<Candidate>> passes(derived.size());  // those before the last
    for (const std::size_t i : order) {
      std::vector<Candidate> steps = after_passes(tape_, derived[i], parameters_);
      if (steps.empty()) continue;
      candidates[i].outputs = steps.back().outputs;
      candidates[i].operations = steps.back().operations;
      passes[i] = std::move(steps);
    }
    const int shortest = std::ranges::min(candidates, {}, &Candidate::operations).operations;
    const bool is_too_large = request_.optimise == OptimiseFor::balanced && shortest > most_measured;
    const std::size_t best = choose(
        tape_, candidates, is_too_large ? OptimiseFor::speed : request_.optimise,
        [this](int count) { return states(count); },
        [&](const MeasuredStates& at) {
          add_compensated(tape_, candidates, parameters_, request_.optimise, at,
                          {by_operations(candidates).front()});
          for (const std::size_t i : order) {
            if (!passes[i].empty()) {
              candidates.push_back(derived[i]);
              candidates.back().name += ", without passes";
              candidates.insert(candidates.end(), passes[i].begin(), passes[i].end() - 1);
            }
            if (const auto stable = in_stable_form(tape_, derived[i], parameters_)) {
              candidates.push_back(*stable);
              const std::vector<Candidate> steps = after_passes(tape_, *stable, parameters_);
              candidates.insert(candidates.end(), steps.begin(), steps.end());
            }
          }
        });
    const std::size_t first_report = result_->candidates.size();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const Candidate& c = candidates[i];
      result_->candidates.push_back({name, c.name, c.operations, i == best, c.error});
    }
    program_.functions.push_back(
        {name, quantities_.meaning(name), candidates[best].outputs, "route: " + candidates[best].name});
    if (!request_.trace) return;
    const std::size_t route = candidates[best].route;
    Kept kept{algorithms[route], std::move(candidates), {derived[route]}, first_report};
    kept.passes[0].name = "best frames";
    for (Candidate c : passes[route]) {
      c.name = c.name.substr(c.name.rfind("after ") + 6);
      kept.passes.push_back(std::move(c));
    }
    kept_.emplace(name, std::move(kept));
  }

  /// Passes over the program itself are costly, so only the cheapest routes see them.
  static constexpr std::size_t finalists = 4;
  /// Operations beyond which balance measures nothing: it would take minutes.
  static constexpr int most_measured = 10'000;

  [[nodiscard]] int cost_of(const std::vector<OutputBlock>& outputs) const {
    return operations_per_call(tape_, roots_of(outputs), parameters_).total();
  }

  static std::vector<OutputBlock> outputs_of(const std::string& function, const TreeRoute& algorithm,
                                             const Mechanism<Expr>& mechanism) {
    try {
      return algorithm.outputs(mechanism);
    } catch (const std::domain_error&) {
      throw UnsupportedError(fmt::format(
          "function {} divides by zero: some joint moves no inertia; give its links mass, fix the "
          "joint, or name functions that need no inverse with --functions",
          function));
    }
  }
  const Model& model_;
  const TreeRequest& request_;
  std::unique_ptr<TreeDerivation> result_;
  Program& program_;
  Tape& tape_;
  TreeQuantities quantities_;
  SampledInputs sampled_inputs_;
  std::vector<NodeId> parameters_;
  std::vector<Frames> frames_;
  std::vector<Frames> stages_;        // for the trace
  std::map<std::string, Kept> kept_;  // by function
};

}  // namespace

const std::vector<std::string>& tree_function_names() {
  static const std::vector<std::string> names = {
      "inverse_dynamics", "bias_forces",         "gravity_forces",
      "mass_matrix",      "forward_dynamics",    "imposed_motion",
      "mass_factor",      "inverse_mass_matrix", "centroidal_momentum",
      "energies",         "forward_kinematics",  "jacobians",
      "regressor"};
  return names;
}

const std::vector<std::string>& standard_tree_functions() {
  static const std::vector<std::string> names = {"inverse_dynamics", "bias_forces", "gravity_forces",
                                                 "mass_matrix", "forward_dynamics"};
  return names;
}

bool is_driven_tree(const Model& model) {
  const auto moves_alone = [](const Coordinate& c) { return c.drive == Drive::active; };
  const auto is_rigid = [](const BodyDescription& b) { return b.modes.empty() && !b.fluid; };
  const auto acts_on_base = [](const GeneralisedForceDescription& f) { return f.index < 6; };
  std::vector<NodeId> roots = {model.potential.id(*model.tape), model.dissipation.id(*model.tape)};
  for (const GeneralisedForceDescription& f : model.forces) roots.push_back(f.force.id(*model.tape));
  const std::vector<NodeId> used = model.tape->reachable(roots);
  const bool depends_on_time = std::ranges::find(used, model.symbols.t) != used.end();
  return !depends_on_time && model.rows.empty() && model.wrenches.empty() &&
         std::ranges::all_of(model.coordinates, moves_alone) && std::ranges::all_of(model.bodies, is_rigid) &&
         std::ranges::none_of(model.forces, acts_on_base);
}

std::unique_ptr<TreeDerivation> derive_tree(const Model& model, const TreeRequest& request) {
  return TreeDeriver(model, request).run();
}

}  // namespace anholon
