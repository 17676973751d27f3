// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/tree_functions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <set>

#include "anholon/articulated.hpp"
#include "anholon/composite.hpp"
#include "anholon/factor.hpp"
#include "derive/loop_tables.hpp"
#include "derive/sampled_inputs.hpp"
#include "derive/tree_inputs.hpp"
#include "derive/tree_kinematics.hpp"
#include "describe/mechanise.hpp"
#include "optimise/accuracy/variants.hpp"
#include "optimise/model/align_parallel.hpp"
#include "optimise/model/merge_fixed.hpp"
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

/// Ways to derive a function in given frames; one that does not apply has no outputs.
struct Algorithm {
  std::string name;
  std::function<std::vector<OutputBlock>(const Mechanism<Expr>&)> outputs;
};

/// What became of a function, for the trace.
struct Kept {
  Algorithm algorithm;
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
        in_(model, program_),
        sampled_inputs_(model) {
    for (const ParameterInfo& p : program_.parameters) parameters_.push_back(p.node);
  }

  std::unique_ptr<TreeDerivation> run() {
    program_.model = model_.name;
    program_.scene = request_.scene;
    program_.name_space = model_.name + "::" + request_.scene;
    program_.source_file = model_.file;
    program_.source_sha256 = model_.sha256;
    for (const std::string& name : request_.functions) {
      if (std::ranges::find(tree_function_names(), name) == tree_function_names().end())
        throw std::invalid_argument(fmt::format("there is no function '{}'; choose from {}", name,
                                                fmt::join(tree_function_names(), ", ")));
    }
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
    const MechanismDescription description = describe_mechanism(model_);
    if (!description.rows.empty() || !description.wrenches.empty())
      throw UnsupportedError(
          fmt::format("model '{}' has constraints or external wrenches: its functions are those of derive()",
                      model_.name));
    Mechanism<Expr> mechanism = mechanise<Expr>(description, in_.parameters, FromExact<Expr>{&tape_});
    for (const Body<Expr>& b : mechanism.bodies) {
      if (!b.modes.empty())
        throw UnsupportedError(
            fmt::format("body '{}' is compliant: the functions of model '{}' are those of derive()", b.name,
                        model_.name));
      if (b.fluid)
        throw UnsupportedError(
            fmt::format("body '{}' has added mass: the functions of model '{}' are those of derive()", b.name,
                        model_.name));
    }
    mechanism.open_section = [this](const std::string& title) { tape_.section(title); };
    described_ = mechanism;
    const int merged = merge_fixed(mechanism);
    merged_ = mechanism;
    result_->passes.push_back(fmt::format("merged {} bodies on fixed joints", merged));
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
    stages_.push_back({"as described", described_});
    Mechanism<Expr> m = merged_;
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
  OutputBlock block(std::string name, std::string unit, std::string meaning, const std::vector<Expr>& v) {
    OutputBlock b{std::move(name), std::move(unit), std::move(meaning), static_cast<int>(v.size()), 1, {}};
    for (const Expr& e : v) b.nodes.push_back(e.id(tape_));
    return b;
  }
  OutputBlock block(std::string name, std::string unit, std::string meaning, const Matrix<Expr>& m) {
    OutputBlock b = block(std::move(name), std::move(unit), std::move(meaning), m.entries());
    b.rows = m.rows();
    b.cols = m.cols();
    return b;
  }

  /// Loops whose straight line would take more operations than that are kept as loops: compilers take long
  /// over such functions, and the instructions no longer fit the caches.
  static constexpr int longest_straight_line = 6000;
  static constexpr const char* loops_route = "loops over the tree";

  /// Derives a function that is emitted as loops, and the one that they start from.
  /// @return false where a straight line does
  bool derive_loops(const std::string& name) {
    RigidTree<Expr> tree(name == "regressor" ? merged_ : frames_[0].mechanism);
    tree.position(in_.r);
    const std::optional<TreeLoops> loops = tree_loops(name, tree);
    if (!loops || count_operations(*loops).total() <= longest_straight_line) return false;
    if (std::ranges::find(program_.functions, loops->from, &Function::name) == program_.functions.end())
      derive(loops->from);
    Function f{name, meaning(name), {}, fmt::format("route: {}", loops_route), loops};
    std::vector<std::vector<Expr>> from;
    for (const OutputBlock& b : straight_line(program_, f).outputs) {
      from.emplace_back();
      for (const NodeId id : b.nodes) from.back().emplace_back(tape_, id);
    }
    const std::vector<std::vector<Expr>> values = values_of(*loops, from);
    f.outputs = blocks_of(name, values);
    program_.functions.push_back(std::move(f));
    result_->candidates.push_back(
        {name, loops_route, operations_per_call(program_, program_.functions.back()).total(), true});
    return true;
  }

  /// Output blocks of the functions that may be loops.
  std::vector<OutputBlock> blocks_of(const std::string& name, const std::vector<std::vector<Expr>>& values) {
    std::vector<OutputBlock> blocks;
    if (name == "mass_factor") {
      blocks = {block("L", "mixed", "unit lower triangular", values[0]),
                block("D", "mixed", "diagonal", values[1])};
      blocks[0].rows = blocks[0].cols = blocks[1].rows;
    } else if (name == "inverse_mass_matrix") {
      blocks = {block("M_inverse", "mixed", "(eta, r) x (eta, r)", values[0])};
      blocks[0].rows = blocks[0].cols = n() + static_cast<int>(in_.r.size());
    } else {
      std::string names;
      for (const Body<Expr>& b : merged_.bodies) names += (names.empty() ? "" : ", ") + b.name;
      blocks = {
          block("Y", "mixed", "columns m, mx, my, mz, Ixx, Iyy, Izz, Ixy, Ixz, Iyz of " + names, values[0])};
      blocks[0].rows = n() + static_cast<int>(in_.r.size());
      blocks[0].cols = 10 * static_cast<int>(merged_.bodies.size());
    }
    return blocks;
  }

  /// Derives a function by every route and keeps the cheapest.
  void derive(const std::string& name) {
    if (std::ranges::find(program_.functions, name, &Function::name) != program_.functions.end()) return;
    if (derive_loops(name)) return;
    std::vector<Candidate> candidates;
    std::vector<Algorithm> algorithms;
    std::set<std::string> hopeless;  // algorithms that lost by a quarter in the first frames
    for (const Frames& frames : frames_) {
      const std::size_t first = candidates.size();
      for (const Algorithm& algorithm : algorithms_of(name)) {
        if (hopeless.contains(algorithm.name)) continue;
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
    std::vector<std::size_t> order(derived.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return derived[i].operations; });
    order.resize(request_.optimise == OptimiseFor::nothing ? 0 : std::min(order.size(), finalists));
    std::vector<std::vector<Candidate>> passes(derived.size());  // those before the last
    for (const std::size_t i : order) {
      std::vector<Candidate> steps = after_passes(tape_, derived[i], parameters_);
      if (steps.empty()) continue;
      candidates[i].outputs = steps.back().outputs;
      candidates[i].operations = steps.back().operations;
      passes[i] = std::move(steps);
    }
    const int shortest_of_all = std::ranges::min(candidates, {}, &Candidate::operations).operations;
    const bool is_too_large = request_.optimise == OptimiseFor::balanced && shortest_of_all > most_measured;
    const std::size_t best = choose(
        tape_, candidates, is_too_large ? OptimiseFor::speed : request_.optimise,
        [this](int count) { return states(count); },
        [&](const MeasuredStates& at) {
          const auto least = std::ranges::min_element(candidates, {}, &Candidate::operations);
          const std::size_t route = least->route;
          std::vector<Candidate> shortest = {*least};
          shortest[0].route = 0;
          add_compensated(tape_, shortest, parameters_, request_.optimise, at, 1);
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
          for (std::size_t i = 1; i < shortest.size(); ++i) {
            candidates.push_back(std::move(shortest[i]));
            candidates.back().route = route;
          }
        });
    const std::size_t first_report = result_->candidates.size();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const Candidate& c = candidates[i];
      result_->candidates.push_back({name, c.name, c.operations, i == best, c.error});
    }
    program_.functions.push_back(
        {name, meaning(name), candidates[best].outputs, "route: " + candidates[best].name});
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

  static std::vector<OutputBlock> outputs_of(const std::string& function, const Algorithm& algorithm,
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
  std::vector<Algorithm> algorithms_of(const std::string& name) {
    using M = const Mechanism<Expr>&;
    if (name == "inverse_dynamics")
      return {{"", [this](M m) {
                 return inverse_dynamics(m, in_.eta, in_.eta_dot, in_.r_dot, in_.r_ddot, true);
               }}};
    if (name == "bias_forces")
      return {{"", [this](M m) { return inverse_dynamics(m, in_.eta, {}, in_.r_dot, zeros(), true); }}};
    if (name == "gravity_forces")
      return {{"", [this](M m) { return inverse_dynamics(m, {}, {}, zeros(), zeros(), false); }}};
    if (name == "mass_matrix")
      return {{"", [this](M m) {
                 return std::vector{block("M", "kg, kg m, kg m^2", "(eta, r) x (eta, r)", mass_matrix(m))};
               }}};
    if (name == "forward_dynamics") {
      return {
          {"articulated bodies",
           [this](M m) { return independent(m) ? forward_dynamics(m, true) : std::vector<OutputBlock>{}; }},
          {"composite bodies and LTDL factor", [this](M m) {
             return factor_may_pay(m) ? forward_dynamics(m, false) : std::vector<OutputBlock>{};
           }}};
    }
    if (name == "imposed_motion")
      return {{"composite body and two sweeps", [this](M m) { return imposed_motion(m); }}};
    if (name == "mass_factor") {
      return {{"composite bodies", [this](M m) {
                 const LtdlFactor<Expr> f = ltdl(mass_matrix(m));
                 Matrix<Expr> L = f.L;
                 for (int i = 0; i < L.rows(); ++i) L(i, i) = 1;
                 return blocks_of("mass_factor", {L.entries(), f.D});
               }}};
    }
    if (name == "inverse_mass_matrix")
      return {{"LTDL factor, unit columns", [this](M m) { return inverse_mass_matrix(m); }}};
    if (name == "centroidal_momentum") {
      return {{"composite bodies", [this](M m) {
                 const CentroidalMomentum<Expr> c = centroidal_momentum(m, in_.state());
                 return std::vector{
                     block("momentum", "kg m/s, kg m^2/s",
                           "linear, and angular about the centre of mass, world axes", six(c.momentum)),
                     block("centre", "m", "centre of mass in the world",
                           std::vector{c.centre.x, c.centre.y, c.centre.z})};
               }}};
    }
    if (name == "energies") {
      return {{"", [this](M m) {
                 const auto e = FreeDynamics<Expr>(m).energies(in_.state());
                 return std::vector{
                     block("kinetic", "J", "kinetic energy", std::vector{e.kinetic}),
                     block("gravity", "J", "potential energy of gravity, zero at the origin of the world",
                           std::vector{e.gravity}),
                     block("elastic", "J", "energy of springs", std::vector{e.elastic}),
                     block("dissipated_power", "W", "lost in dampers", std::vector{e.dissipated_power})};
               }}};
    }
    if (name == "forward_kinematics")
      return {{"", [this](M m) { return is_first(m) ? forward_kinematics() : std::vector<OutputBlock>{}; }}};
    if (name == "jacobians")
      return {{"", [this](M m) { return is_first(m) ? jacobians() : std::vector<OutputBlock>{}; }}};
    if (name == "regressor")
      return {{"", [this](M m) { return is_first(m) ? regressors() : std::vector<OutputBlock>{}; }}};
    if (name == regressor_motion)
      return {{"", [this](M m) { return is_first(m) ? regressor_motions() : std::vector<OutputBlock>{}; }}};
    throw std::logic_error("a function without a derivation");
  }
  /// Whether the LTDL factor may take less than the articulated bodies: it grows with the squares of the
  /// depths, they with the number of bodies, of which none takes 400 operations.
  [[nodiscard]] bool factor_may_pay(const Mechanism<Expr>& m) const {
    if (!independent(m)) return true;
    std::vector<double> depth(m.bodies.size(), n());
    double operations = 0;
    for (std::size_t k = 1; k < m.bodies.size(); ++k) {
      const double above = depth[static_cast<std::size_t>(m.bodies[k].parent)];
      depth[k] = above + 1;
      operations += above * above;  // a multiplication and a subtraction for each pair above
    }
    return operations < 400.0 * static_cast<double>(m.bodies.size());
  }

  [[nodiscard]] bool independent(const Mechanism<Expr>& m) const {
    RigidTree<Expr> tree(m);
    tree.position(in_.r);
    return joints_are_independent(tree);
  }

  [[nodiscard]] std::string meaning(const std::string& name) const {
    if (name == "inverse_dynamics")
      return "Joint forces and, for a moving reference body, the wrench on it that a motion needs.";
    if (name == "bias_forces")
      return "What inverse dynamics needs without accelerations: Coriolis, centrifugal and gravity forces, "
             "friction.";
    if (name == "gravity_forces")
      return "What gravity alone asks of the joints and of the reference body, at rest.";
    if (name == "mass_matrix") return "Mass matrix M of (eta, r_dot).";
    if (name == "forward_dynamics") return "Accelerations under joint forces tau.";
    if (name == "imposed_motion")
      return "Acceleration of a free reference body and forces of the joints under imposed joint motion.";
    if (name == "mass_factor") return "M = L^T D L.";
    if (name == "inverse_mass_matrix") return "Inverse of M.";
    if (name == "centroidal_momentum") return "Momentum of the robot about its centre of mass.";
    if (name == "energies") return "Kinetic and potential energy, power lost.";
    if (name == "forward_kinematics") return "Poses of all links in the world, R row-major and p.";
    if (name == "jacobians")
      return "Twists of the links at the tips in their own axes: J (eta, r_dot); their derivative is J "
             "(eta_dot, r_ddot) + bias.";
    if (name == "regressor")
      return fmt::format(
          "Inverse dynamics without springs, dampers{} as Y pi, linear in the inertial figures pi of the "
          "bodies.",
          has_armatures() ? ", friction and armatures" : " and friction");
    if (name == regressor_motion) return "Motion of bodies and joints, from which regressor() starts.";
    return "";
  }

  [[nodiscard]] bool has_armatures() const {
    return std::ranges::any_of(merged_.bodies, [](const Body<Expr>& b) { return !b.armature.is_zero(); });
  }

  // ---- quantities
  // ----------------------------------------------------------------------------------------------
  [[nodiscard]] std::vector<Expr> zeros() const { return std::vector<Expr>(in_.r.size(), Expr(0)); }
  [[nodiscard]] int n() const { return static_cast<int>(free_components(model_.group).size()); }
  [[nodiscard]] std::vector<Expr> free_part(const Spatial<Expr>& x) const {
    std::vector<Expr> v;
    for (const int c : free_components(model_.group)) v.push_back(x[c]);
    return v;
  }

  /// Springs, dampers and friction: generalised forces of the coordinates; empty where there are none.
  std::vector<Expr> own_forces(const Mechanism<Expr>& m, const Spatial<Expr>& eta,
                               const std::vector<Expr>& r_dot) const {
    if (!m.generalised_forces) return {};
    State<Expr> state = in_.state();
    state.eta = eta;
    state.r_dot = r_dot;
    std::vector<Expr> force(6 + r_dot.size(), Expr(0));
    m.section("springs, dampers and friction");
    m.generalised_forces(state, force);
    return force;
  }

  /// Generalised forces in the order (reference body, coordinates) of a motion whose base acceleration is a.
  std::pair<Spatial<Expr>, std::vector<Expr>> sweep(const Mechanism<Expr>& m, const Spatial<Expr>& eta,
                                                    const Vec3<Expr>& wd, const Vec3<Expr>& a,
                                                    const std::vector<Expr>& r_dot,
                                                    const std::vector<Expr>& r_ddot, bool own) {
    RigidTree<Expr> tree(m);
    tree.position(in_.r);
    tree.move_base(eta.angular, wd, a);
    tree.move(r_dot, r_ddot);
    Spatial<Expr> base;
    std::vector<Expr> force = tree.inverse_dynamics(base);
    if (!own) return {base, force};
    const std::vector<Expr> applied = own_forces(m, eta, r_dot);
    for (std::size_t i = 0; i < applied.size(); ++i) {
      if (i < 6) base[static_cast<int>(i)] = base[static_cast<int>(i)] - applied[i];
      if (i >= 6) force[i - 6] -= applied[i];
    }
    return {base, force};
  }

  std::vector<OutputBlock> inverse_dynamics(const Mechanism<Expr>& m, const Spatial<Expr>& eta,
                                            const Spatial<Expr>& eta_dot, const std::vector<Expr>& r_dot,
                                            const std::vector<Expr>& r_ddot, bool own) {
    m.section(m.bodies[0].name + ": acceleration");
    const Vec3<Expr> a = eta_dot.linear + cross(eta.angular, eta.linear) - transposed_times(in_.R, m.gravity);
    const auto [base, force] = sweep(m, eta, eta_dot.angular, a, r_dot, r_ddot, own);
    return {block("base_wrench", "N, N m", "on the reference body about its origin, in its own axes",
                  free_part(base)),
            block("tau", "N m or N", "forces of the joints", force)};
  }

  /// The free components of the base acceleration vanish in a first sweep; what that sweep leaves on the base
  /// is balanced by the inertia of all bodies taken as one. Empty for a fixed reference body.
  std::vector<OutputBlock> imposed_motion(const Mechanism<Expr>& m) {
    if (n() == 0) return {};
    const auto components = free_components(model_.group);
    const Vec3<Expr> drift = cross(in_.eta.angular, in_.eta.linear) - transposed_times(in_.R, m.gravity);
    const Spatial<Expr> wrench = sweep(m, in_.eta, {}, drift, in_.r_dot, in_.r_ddot, true).first;
    const Matrix<Expr> M = mass_matrix(m);
    Matrix<Expr> base(n(), n());
    std::vector<Expr> b;
    for (int i = 0; i < n(); ++i) {
      for (int j = 0; j < n(); ++j) base(i, j) = M(i, j);
      b.push_back(-wrench[components[static_cast<std::size_t>(i)]]);
    }
    m.section("acceleration of the reference body");
    const std::vector<Expr> x = ltdl(base).solve(b);
    Spatial<Expr> eta_dot;
    for (std::size_t i = 0; i < x.size(); ++i) eta_dot[components[i]] = x[i];
    const std::vector<Expr> tau =
        sweep(m, in_.eta, eta_dot.angular, eta_dot.linear + drift, in_.r_dot, in_.r_ddot, true).second;
    return {block("eta_dot", "m/s^2, rad/s^2", "derivative of eta", x),
            block("tau", "N m or N", "forces of the joints", tau)};
  }

  Matrix<Expr> mass_matrix(const Mechanism<Expr>& m) {
    RigidTree<Expr> tree(m);
    tree.position(in_.r);
    return composite_mass_matrix(tree);
  }

  [[nodiscard]] bool is_first(const Mechanism<Expr>& m) const { return &m == &frames_[0].mechanism; }
  static std::vector<Expr> six(const Spatial<Expr>& x) {
    std::vector<Expr> v;
    for (int i = 0; i < 6; ++i) v.push_back(x[i]);
    return v;
  }

  std::vector<OutputBlock> inverse_mass_matrix(const Mechanism<Expr>& m) {
    const LtdlFactor<Expr> factor = ltdl(mass_matrix(m));
    const int size = factor.L.rows();
    Matrix<Expr> inverse(size, size);
    for (int c = 0; c < size; ++c) {
      std::vector<Expr> e(static_cast<std::size_t>(size), Expr(0));
      e[static_cast<std::size_t>(c)] = 1;
      const std::vector<Expr> x = factor.solve(e);
      for (int i = 0; i <= c; ++i) inverse(i, c) = inverse(c, i) = x[static_cast<std::size_t>(i)];
    }
    return blocks_of("inverse_mass_matrix", {inverse.entries()});
  }

  std::vector<OutputBlock> forward_kinematics() {
    std::vector<Mat3<Expr>> R;
    std::vector<Vec3<Expr>> p;
    FreeDynamics<Expr>(described_).poses(in_.state(), R, p);
    std::vector<OutputBlock> outputs;
    for (std::size_t k = 0; k < R.size(); ++k) {
      const std::string& name = described_.bodies[k].name;
      outputs.push_back(block("R_" + name, "1", "orientation of link " + name,
                              std::vector<Expr>(R[k].m.begin(), R[k].m.end())));
      outputs.back().rows = outputs.back().cols = 3;
      outputs.push_back(
          block("p_" + name, "m", "origin of link " + name, std::vector{p[k].x, p[k].y, p[k].z}));
    }
    return outputs;
  }

  std::vector<OutputBlock> jacobians() {
    std::vector<int> tips;
    for (std::size_t k = 0; k < described_.bodies.size(); ++k) {
      const bool is_parent = std::ranges::any_of(
          described_.bodies, [&](const Body<Expr>& b) { return b.parent == static_cast<int>(k); });
      if (!is_parent) tips.push_back(static_cast<int>(k));
    }
    const std::vector<FrameJacobian<Expr>> frames = frame_jacobians(described_, in_.state(), tips);
    std::vector<OutputBlock> outputs;
    for (std::size_t i = 0; i < tips.size(); ++i) {
      const std::string& name = described_.bodies[static_cast<std::size_t>(tips[i])].name;
      outputs.push_back(block("J_" + name, "mixed", "6 x (eta, r)", frames[i].J));
      outputs.push_back(block("bias_" + name, "m/s^2, rad/s^2", "linear part first", frames[i].bias));
    }
    return outputs;
  }

  /// The tree without fixed joints in the described frames, moving as the inputs say.
  RigidTree<Expr> moving_tree() {
    RigidTree<Expr> tree(merged_);
    tree.position(in_.r);
    tree.move_base(in_.eta.angular, in_.eta_dot.angular,
                   in_.eta_dot.linear + cross(in_.eta.angular, in_.eta.linear) -
                       transposed_times(in_.R, merged_.gravity));
    tree.move(in_.r_dot, in_.r_ddot);
    return tree;
  }

  std::vector<OutputBlock> regressors() {
    return blocks_of("regressor", {regressor(moving_tree()).entries()});
  }

  /// What the loops of the regressor start from.
  std::vector<OutputBlock> regressor_motions() {
    const RegressorMotion m = motion_for_regressor(moving_tree());
    std::vector<OutputBlock> blocks = {
        block("motion", "mixed",
              "of each body: orientation and place in the reference body's frame, angular velocity, its "
              "derivative, "
              "acceleration minus gravity in its own",
              m.motion),
        block("axes", "mixed", "of each body's joint: twist at unit rate in the reference body's frame",
              m.axes)};
    for (OutputBlock& b : blocks) {
      b.rows = static_cast<int>(merged_.bodies.size());
      b.cols = static_cast<int>(b.nodes.size()) / b.rows;
    }
    return blocks;
  }

  /// With A = eta_dot.linear + Omega x V - R^T gravity as the unknown of a free reference body, gravity drops
  /// out of all but the last line; a reference body that cannot accelerate everywhere carries gravity as its
  /// own acceleration.
  std::vector<OutputBlock> forward_dynamics(const Mechanism<Expr>& m, bool articulated_bodies) {
    m.section(m.bodies[0].name + ": acceleration");
    const Vec3<Expr> drift = cross(in_.eta.angular, in_.eta.linear) - transposed_times(in_.R, m.gravity);
    const auto components = free_components(model_.group);
    const bool is_free = model_.group == GroupKind::SE3;
    const Vec3<Expr> a = is_free ? Vec3<Expr>{} : drift;
    const std::vector<Expr> applied = own_forces(m, in_.eta, in_.r_dot);
    std::vector<Expr> tau = in_.tau;
    for (std::size_t i = 6; i < applied.size(); ++i) tau[i - 6] += applied[i];
    Spatial<Expr> eta_dot;
    std::vector<Expr> r_ddot;
    if (articulated_bodies) {
      RigidTree<Expr> tree(m);
      tree.position(in_.r);
      tree.move_base(in_.eta.angular, {}, a);
      tree.move(in_.r_dot, zeros());
      TreeAcceleration<Expr> result = articulated_acceleration(tree, tau);
      eta_dot = result.base;
      r_ddot = std::move(result.r_ddot);
    } else {
      const auto [base, force] = sweep(m, in_.eta, {}, a, in_.r_dot, zeros(), false);
      const Matrix<Expr> M = mass_matrix(m);
      m.section("factor and solution");
      std::vector<Expr> b;
      for (const int c : components) b.push_back(-base[c]);
      for (std::size_t i = 0; i < tau.size(); ++i) b.push_back(tau[i] - force[i]);
      const std::vector<Expr> x = ltdl(M).solve(b);
      for (std::size_t i = 0; i < components.size(); ++i) eta_dot[components[i]] = x[i];
      r_ddot.assign(x.begin() + n(), x.end());
    }
    if (is_free) eta_dot.linear -= drift;
    return {block("eta_dot", "m/s^2, rad/s^2", "derivative of eta", free_part(eta_dot)),
            block("r_ddot", "rad/s^2 or m/s^2", "second derivatives of r", r_ddot)};
  }

  const Model& model_;
  const TreeRequest& request_;
  std::unique_ptr<TreeDerivation> result_;
  Program& program_;
  Tape& tape_;
  TreeInputs in_;
  SampledInputs sampled_inputs_;
  std::vector<NodeId> parameters_;
  Mechanism<Expr> described_;  // every link a body
  Mechanism<Expr> merged_;     // without fixed joints, in the described frames
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
