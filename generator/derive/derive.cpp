// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/derive.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include "algebra/closed_form.hpp"
#include "anholon/charts.hpp"
#include "anholon/free_dynamics.hpp"
#include "derive/articulated_route.hpp"
#include "derive/charts.hpp"
#include "derive/sampled_inputs.hpp"
#include "derive/symbols.hpp"
#include "describe/function_names.hpp"
#include "describe/mechanise.hpp"
#include "optimise/accuracy/variants.hpp"
#include "optimise/model/merge_fixed.hpp"
#include "optimise/tape/count.hpp"
#include "optimise/tape/passes.hpp"

namespace anholon {
namespace {

constexpr int random_samples = 24;

std::vector<int> range(int n) {
  std::vector<int> r(static_cast<std::size_t>(n));
  std::iota(r.begin(), r.end(), 0);
  return r;
}

/// One route to a function: its outputs on the tape.
struct Route {
  std::string name;
  std::vector<OutputBlock> outputs;
};

std::vector<NodeId> roots_of(const Route& r) {
  std::vector<NodeId> roots;
  for (const OutputBlock& b : r.outputs) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  return roots;
}

/// A partition of the velocities with its kinematic reduction, in the chart that is derived at the moment.
struct Reduced {
  Partition partition;
  RankAnalysis ranks;
  KernelAtlas atlas;
  KinematicReduction* reduction = nullptr;
  [[nodiscard]] int k() const { return reduction->k(); }
};

class Deriver {
 public:
  Deriver(const Model& model, const DeriveRequest& request)
      : model_(model),
        request_(request),
        result_(std::make_unique<Derivation>()),
        program_(result_->program),
        tape_(program_.tape),
        motion_partition_(partition_of(model, request.torque_driven)),
        symbols_(model, partition_of(model), program_),
        description_(describe_mechanism(model)),
        described_(mechanise<Expr>(description_, symbols_.parameters(), FromExact<Expr>{&tape_})),
        mechanism_(merged(described_)),
        dynamics_(mechanism_),
        samples_(sample_states(model, random_samples)),
        names_(velocity_names(model)) {
    described_.open_section =
        mechanism_.open_section = [this](const std::string& title) { tape_.section(title); };
    for (const Parameter& p : model.parameters) defaults_.push_back(p.value);
    for (const ParameterInfo& p : program_.parameters) parameter_nodes_.push_back(p.node);
  }

  std::unique_ptr<Derivation> run() {
    program_.model = model_.name;
    program_.scene = request_.scene;
    program_.name_space = model_.name + "::" + request_.scene;
    program_.source_file = model_.file;
    program_.source_sha256 = model_.sha256;
    for (const std::string& name : request_.functions) {
      if (std::ranges::find(function_names(), name) == function_names().end()) {
        throw std::invalid_argument(fmt::format("there is no function '{}'; choose from {}", name,
                                                fmt::join(function_names(), ", ")));
      }
    }
    motion_ = reduce(motion_partition_);
    atlas_ = &motion_.atlas;
    nu_ = symbols_.block("nu", motion_.k(), "mixed", "reduced velocities: " + meaning_of_nu(motion_));
    r_a_dot_ = symbols_.block("r_a_dot", motion_partition_.s_a(), "rad/s or m/s", "rates of r_a");
    r_a_ddot_ =
        symbols_.block("r_a_ddot", motion_partition_.s_a(), "rad/s^2 or m/s^2", "second derivatives of r_a");

    prepare_state_jacobian();
    derive_kinematics();
    derive_constraints();
    derive_free_dynamics();
    derive_reduced_dynamics();
    derive_state_jacobian();
    derive_torques_and_multipliers();
    derive_compatibility();
    derive_torque_driven();
    derive_position_conditions();
    derive_energies();
    derive_poses();
    derive_further_charts();
    result_->reduction = report(motion_);
    for (const auto& chart : motion_.atlas.charts) {
      if (request_.rates)
        result_->rates.push_back(
            symbols_.motion(merged(motion_partition_, chart->velocities(r_a_dot_, nu_), r_a_dot_)));
    }
    note_header();
    if (request_.trace) trace();  // last: it leaves nodes on the tape, which no function needs
    return std::move(result_);
  }

 private:
  static Mechanism<Expr> merged(Mechanism<Expr> mechanism) {
    merge_fixed(mechanism);
    return mechanism;
  }

  [[nodiscard]] bool wanted(const std::string& name) const {
    return request_.functions.empty() ||
           std::ranges::find(request_.functions, name) != request_.functions.end();
  }

  /// Of what is derived on demand only.
  [[nodiscard]] bool wants_state_jacobian() const {
    return request_.state_jacobian ||
           std::ranges::find(request_.functions, "state_jacobian") != request_.functions.end();
  }

  // ---- outputs
  // -------------------------------------------------------------------------------------------------
  OutputBlock block(std::string name, std::string unit, std::string meaning, const Matrix<Expr>& m) {
    OutputBlock b{std::move(name), std::move(unit), std::move(meaning), m.rows(), m.cols(), {}};
    for (const Expr& e : m.entries()) b.nodes.push_back(e.id(tape_));
    return b;
  }
  OutputBlock block(std::string name, std::string unit, std::string meaning, const std::vector<Expr>& v) {
    OutputBlock b{std::move(name), std::move(unit), std::move(meaning), static_cast<int>(v.size()), 1, {}};
    for (const Expr& e : v) b.nodes.push_back(e.id(tape_));
    return b;
  }

  /// Keeps the cheapest route; the closed form of the cheapest one is a further candidate.
  /// @param simplified  let the closed form compete: it expands products, and with them loses digits again
  void emit(const std::string& name, const std::string& meaning, std::vector<Route> routes,
            const std::string& remark = "", bool simplified = true) {
    for (Route& r : routes) std::erase_if(r.outputs, [](const OutputBlock& b) { return b.nodes.empty(); });
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
      if (const auto closed = closed_form(tape_, roots_of(base)))
        add("closed form", with_roots(base, *closed));
    }
    if (request_.optimise == OptimiseFor::speed) add_after_passes(candidates);
    const std::size_t best = choose(
        tape_, candidates, request_.optimise, [this] { return measured_states_of(atlas_, chart_); },
        [&] {
          add_stable_forms(candidates);
          if (request_.optimise == OptimiseFor::accuracy) add_after_passes(candidates);
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

  void add_stable_forms(std::vector<Candidate>& candidates) {
    const std::size_t routes = candidates.size();
    for (std::size_t i = 0; i < routes; ++i) {
      if (auto stable = in_stable_form(tape_, candidates[i], parameter_nodes_))
        candidates.push_back(std::move(*stable));
    }
  }
  void add_after_passes(std::vector<Candidate>& candidates) {
    const std::size_t routes = candidates.size();
    for (std::size_t i = 0; i < routes; ++i) {
      for (Candidate& c : after_passes(tape_, candidates[i], parameter_nodes_))
        candidates.push_back(std::move(c));
    }
  }

  // ---- rounding
  // ------------------------------------------------------------------------------------------------
  /// Random states; where there are several charts, those at which this one is the best.
  std::vector<std::vector<double>> measured_states_of(const KernelAtlas* atlas, std::size_t chart) {
    const std::size_t charts = atlas == nullptr ? 1 : atlas->charts.size();
    const int times = static_cast<int>(std::min<std::size_t>(charts, 8));
    std::vector<std::vector<double>> states = sampled_inputs(model_, program_, measured_states * times);
    if (charts < 2) return states;
    std::vector<NodeId> quality;
    for (const Expr& e : atlas->quality) quality.push_back(e.id(tape_));
    std::erase_if(states, [&](const std::vector<double>& inputs) {
      return best_chart(std::span<const double>(reproducible_values(tape_, quality, inputs))) != chart;
    });
    if (states.size() > measured_states) states.resize(measured_states);
    return states;
  }

  /// What all candidates lose, and what stable forms and each pass make of the route that was kept.
  void trace() {
    for (Traced& t : traced_) {
      Candidate route = t.candidates[t.candidates[t.best].route];
      route.name = "as derived";
      std::vector<Candidate> steps = {route};
      route.name.clear();
      if (auto stable = in_stable_form(tape_, route, parameter_nodes_)) steps.push_back(std::move(*stable));
      for (const AfterPass& step : run_passes(tape_, roots_of(route.outputs), parameter_nodes_))
        steps.push_back({step.pass, with_roots(route.outputs, step.roots), step.operations});
      const auto states = measured_states_of(t.atlas, t.chart);
      const auto given = [&] { return states; };
      measure(tape_, t.candidates, given);
      measure(tape_, steps, given);
      for (std::size_t i = 0; i < t.candidates.size(); ++i)
        result_->candidates[t.first_report + i].error = t.candidates[i].error;
      for (const Candidate& c : steps) result_->trace.push_back({t.function, c.name, c.operations, c.error});
    }
  }

  // ---- reduction
  // -----------------------------------------------------------------------------------------------
  Reduced reduce(const Partition& partition) {
    Reduced r;
    r.partition = partition;
    r.ranks = analyse_ranks(description_, defaults_, partition, samples_, request_.leading_rows);
    tape_.section("constraints");
    const Matrix<Expr> G = dynamics_.constraints(symbols_.position()).first;
    const std::vector<int> rows = range(G.rows());
    std::vector<int> preferred;
    for (const std::string& name : model_.free_velocities) {
      const auto at = std::ranges::find(partition.passive,
                                        static_cast<int>(std::ranges::find(names_, name) - names_.begin()));
      if (at != partition.passive.end())
        preferred.push_back(static_cast<int>(at - partition.passive.begin()));
    }
    std::vector<std::string> passive_names;
    for (const int i : partition.passive) passive_names.push_back(names_[static_cast<std::size_t>(i)]);
    tape_.section("kernel");
    r.atlas = choose_atlas(tape_, symbols_,
                           {&model_,
                            {G.block(rows, partition.passive), G.block(rows, partition.active)},
                            &r.ranks,
                            request_.inverse,
                            preferred,
                            passive_names,
                            samples_});
    r.reduction = r.atlas.charts.front().get();
    return r;
  }

  /// Puts passive and active entries into declared order (n + s).
  static std::vector<Expr> merged(const Partition& p, const std::vector<Expr>& passive,
                                  const std::vector<Expr>& active) {
    std::vector<Expr> v(p.passive.size() + p.active.size(), Expr(0));
    for (std::size_t i = 0; i < p.passive.size(); ++i) v[static_cast<std::size_t>(p.passive[i])] = passive[i];
    for (std::size_t i = 0; i < p.active.size(); ++i) v[static_cast<std::size_t>(p.active[i])] = active[i];
    return v;
  }
  static std::vector<Expr> picked(const std::vector<Expr>& v, const std::vector<int>& indices) {
    std::vector<Expr> r;
    for (const int i : indices) r.push_back(v[static_cast<std::size_t>(i)]);
    return r;
  }
  /// eta, r_p and (torque-driven) r_a parts of the passive entries, as output blocks.
  std::vector<OutputBlock> split_passive(const Partition& p, const std::vector<Expr>& passive,
                                         const std::string& order) {
    const Partition original = partition_of(model_);
    std::vector<Expr> eta(passive.begin(), passive.begin() + p.n);
    std::vector<Expr> r_p, r_a;
    for (auto i = static_cast<std::size_t>(p.n); i < p.passive.size(); ++i) {
      const bool is_active = std::ranges::find(original.active, p.passive[i]) != original.active.end();
      (is_active ? r_a : r_p).push_back(passive[i]);
    }
    const bool acceleration = order == "dot";
    const std::string driven = p.active.empty() && request_.torque_driven.empty() ? "r_a" : "r_d";
    return {block(acceleration ? "eta_dot" : "eta", acceleration ? "m/s^2, rad/s^2" : "m/s, rad/s",
                  "twist of the reference body in its own axes, linear part first", eta),
            block(acceleration ? "r_p_ddot" : "r_p_dot", "per r_p", "passive coordinates", r_p),
            block(driven + (acceleration ? "_ddot" : "_dot"), "per r_a", "torque-driven coordinates", r_a)};
  }

  [[nodiscard]] ReductionReport report(const Reduced& of) const {
    ReductionReport r{of.partition,        of.ranks, of.atlas.charts.front()->kernel(),
                      request_.inverse,    {},       of.atlas.first_basis_singular_at,
                      of.atlas.singular_at};
    for (const auto& chart : of.atlas.charts) r.charts.push_back(chart->kernel());
    return r;
  }

  [[nodiscard]] static std::string meaning_of_nu(const Reduced& of) {
    const auto& charts = of.atlas.charts;
    std::string text = charts.front()->kernel().description;
    for (std::size_t c = 1; c < charts.size(); ++c)
      text += fmt::format("; in chart {}: {}", c + 1, charts[c]->kernel().description);
    return text;
  }

  /// The functions that know nu, once more for every further chart, and how good each chart is.
  void derive_further_charts() {
    const KernelAtlas& atlas = motion_.atlas;
    if (atlas.charts.size() < 2) return;
    for (std::size_t c = 1; c < atlas.charts.size(); ++c) {
      prefix_ = chart_prefix(c);
      chart_ = c;
      motion_.reduction = atlas.charts[c].get();
      derive_kinematics();
      derive_reduced_dynamics();
      derive_state_jacobian();
      derive_torques_and_multipliers();
      derive_compatibility();
    }
    prefix_.clear();
    chart_ = 0;
    motion_.reduction = atlas.charts.front().get();
    emit_quality(atlas, "chart_quality", "nu", "reduced_velocities", "kinematics");
  }
  void emit_quality(const KernelAtlas& atlas, const std::string& name, const std::string& nu,
                    const std::string& to, const std::string& from) {
    emit(name,
         fmt::format(
             "How good each chart is here, from 1 down to 0 where it is singular. Change where that in use "
             "falls below a quarter of the best: {} is then what {} of the new chart makes of what {} of the "
             "old one gives.",
             nu, to, from),
         {{"elimination", {block("quality", "1", "one for each chart", atlas.quality)}}});
  }

  // ---- quantities
  // ----------------------------------------------------------------------------------------------
  void derive_kinematics() {
    const KinematicReduction& k = *motion_.reduction;
    if (wanted("kinematics")) {
      const std::vector<Expr> passive = k.velocities(r_a_dot_, nu_);
      std::vector<OutputBlock> outputs = split_passive(motion_partition_, passive, "");
      outputs.push_back(block("H", "mixed", "kernel of (A, B_p), rows (eta, r_p)", k.kernel().H));
      outputs.push_back(block("J", "mixed", "rows (eta, r_p)", k.kernel().J));
      emit("kinematics", "Passive velocities from reduced ones, eq. (11): (eta, r_p_dot) = J r_a_dot + H nu.",
           {{"kernel", outputs}});
    }
    if (wanted("reduced_velocities")) {
      const std::vector<Expr> passive = full_passive();
      emit("reduced_velocities",
           "Reduced velocities of admissible ones: the inverse of eq. (11) on its range.",
           {{"kernel",
             {block("nu", "mixed", "reduced velocities", k.reduced_velocities(passive, r_a_dot_))}}});
    }
  }

  std::vector<Expr> eta_input() {
    return symbols_.block("eta", motion_partition_.n, "m/s, rad/s",
                          "twist of the reference body in its own axes, linear part first");
  }
  std::vector<Expr> r_p_dot_input() {
    return symbols_.block("r_p_dot", partition_of(model_).s_p(), "rad/s or m/s", "rates of r_p");
  }
  /// eta and all passive rates as inputs, in the order of the motion partition.
  std::vector<Expr> full_passive() {
    std::vector<Expr> passive = eta_input();
    const std::vector<Expr> r_p_dot = r_p_dot_input();
    passive.insert(passive.end(), r_p_dot.begin(), r_p_dot.end());
    if (motion_partition_.passive.size() >
        passive.size()) {  // torque-driven coordinates in the reduced dynamics
      const auto driven =
          symbols_.block("r_d_dot", static_cast<int>(motion_partition_.passive.size() - passive.size()),
                         "rad/s or m/s", "rates of torque-driven coordinates");
      passive.insert(passive.end(), driven.begin(), driven.end());
    }
    return passive;
  }
  std::vector<Expr> full_velocity() { return merged(motion_partition_, full_passive(), r_a_dot_); }

  void derive_constraints() {
    if (!wanted("constraints") || mechanism_.rows.empty()) return;
    tape_.section("constraints");
    const auto [G, bias] = dynamics_.constraints(symbols_.moving(full_velocity()));
    const Partition p = partition_of(model_);
    const std::vector<int> rows = range(G.rows());
    std::vector<int> coordinates(p.passive.begin() + p.n, p.passive.end());
    emit(
        "constraints",
        "Rows of eq. (2), A eta + B_p r_p_dot + B_a r_a_dot = 0, and the bias (A_dot eta + B_p_dot r_p_dot + "
        "B_a_dot r_a_dot).",
        {{"recursion",
          {block("A", "mixed", "rows x n", G.block(rows, range(p.n))),
           block("B_p", "mixed", "rows x s_p", G.block(rows, coordinates)),
           block("B_a", "mixed", "rows x s_a", G.block(rows, p.active)), block("bias", "mixed", "rows", bias),
           block("lambda_stat_basis", "1", "basis of ker (A, B_p)^T, rows x (rows - rank)",
                 motion_.reduction->static_basis())}}});
  }

  void derive_free_dynamics() {
    if (!wanted("free_dynamics")) return;
    const State<Expr> state = symbols_.moving(full_velocity());
    const Matrix<Expr> M = dynamics_.mass_matrix(state);
    const std::vector<Expr> f = dynamics_.forces(state);
    const Partition p = partition_of(model_);
    const std::vector<int> eta = range(p.n);
    const std::vector<int> r_p(p.passive.begin() + p.n, p.passive.end());
    emit("free_dynamics",
         "Blocks of eq. (1) with lambda = 0 and tau_a = 0, by sweeps of the recursion (section V.B).",
         {{"unit sweeps",
           {block("M_eta_eta", "kg, kg m, kg m^2", "n x n", M.block(eta, eta)),
            block("M_p", "mixed", "s_p x n", M.block(r_p, eta)),
            block("M_a", "mixed", "s_a x n", M.block(p.active, eta)),
            block("m_pp", "mixed", "s_p x s_p", M.block(r_p, r_p)),
            block("m_pa", "mixed", "s_p x s_a", M.block(r_p, p.active)),
            block("m_aa", "mixed", "s_a x s_a", M.block(p.active, p.active)),
            block("f", "N, N m", "n", picked(f, eta)), block("Q_p", "N m or N", "s_p", picked(f, r_p)),
            block("Q_a", "N m or N", "s_a", picked(f, p.active))}}});
  }

  /// Reduced mass matrix, forces and drift of one partition.
  struct ReducedDynamics {
    std::vector<Expr> velocity;           // n + s
    std::vector<Expr> bias_acceleration;  // n + s: at nu_dot = 0
    Matrix<Expr> M_r;
    std::vector<Expr> f_r;
  };
  /// @param input_force  (passive) given forces on passive velocities, e.g. torques
  /// @param project  run the recursion on admissible motions; else form (66)-(68) from all blocks
  ReducedDynamics reduced_dynamics(const Reduced& of, const std::vector<Expr>& nu,
                                   const std::vector<Expr>& r_a_dot, const std::vector<Expr>& r_a_ddot,
                                   const std::vector<Expr>& input_force, bool project) {
    const KinematicReduction& k = *of.reduction;
    const Partition& p = of.partition;
    ReducedDynamics d;
    tape_.section("admissible velocities");
    const std::vector<Expr> passive = k.velocities(r_a_dot, nu);
    d.velocity = merged(p, passive, r_a_dot);
    const State<Expr> state = symbols_.moving(d.velocity);
    std::vector<Expr> bias;
    if (!mechanism_.rows.empty()) bias = dynamics_.constraints(state).second;
    tape_.section("drift of the kernel");
    std::vector<Expr> gamma = k.drift(r_a_dot, nu, bias, symbols_.motion(d.velocity));
    const std::vector<Expr> imposed = k.kernel().J * r_a_ddot;
    for (std::size_t i = 0; i < gamma.size(); ++i) gamma[i] += imposed[i];
    d.bias_acceleration = merged(p, gamma, r_a_ddot);
    const Matrix<Expr>& H = k.kernel().H;
    const Matrix<Expr> Ht = H.transposed();
    d.M_r = Matrix<Expr>(H.cols(), H.cols());
    if (project) {
      const std::vector<Expr> residual =
          picked(dynamics_.inverse_dynamics(state, d.bias_acceleration), p.passive);
      tape_.section("reduced forces");
      std::vector<Expr> force = input_force;
      for (std::size_t i = 0; i < force.size(); ++i) force[i] -= residual[i];
      d.f_r = Ht * force;
      for (int c = 0; c < H.cols(); ++c) {
        std::vector<Expr> h;
        for (int i = 0; i < H.rows(); ++i) h.push_back(H(i, c));
        const std::vector<Expr> Mh =
            picked(dynamics_.mass_times(state, merged(p, h, std::vector<Expr>(p.active.size(), Expr(0)))),
                   p.passive);
        tape_.section("reduced mass matrix");
        const std::vector<Expr> column = Ht * Mh;
        for (int i = c; i < H.cols(); ++i) d.M_r(i, c) = d.M_r(c, i) = column[static_cast<std::size_t>(i)];
      }
    } else {
      const Matrix<Expr> M = dynamics_.mass_matrix(state);
      const std::vector<Expr> f = dynamics_.forces(state);
      tape_.section("reduced mass matrix");
      d.M_r = Ht * (M.block(p.passive, p.passive) * H);  // (66)
      for (int i = 0; i < H.cols(); ++i) {
        for (int j = 0; j < i; ++j) d.M_r(j, i) = d.M_r(i, j);
      }
      tape_.section("reduced forces");
      std::vector<Expr> force = input_force;  // (68)
      const std::vector<Expr> carried = M.block(p.passive, p.passive) * gamma;
      const std::vector<Expr> driven = M.block(p.passive, p.active) * r_a_ddot;
      for (std::size_t i = 0; i < force.size(); ++i)
        force[i] += f[static_cast<std::size_t>(p.passive[i])] - driven[i] - carried[i];
      d.f_r = Ht * force;  // (67)
    }
    return d;
  }

  std::vector<Expr> no_force(const Partition& p) const {
    return std::vector<Expr>(p.passive.size(), Expr(0));
  }

  /// Torques on the coordinates of a partition that are torque-driven, as forces on its passive velocities.
  std::vector<Expr> driving_force(const Partition& p) {
    std::vector<Expr> force = no_force(p);
    const Partition original = partition_of(model_);
    std::vector<std::size_t> driven;
    for (std::size_t i = 0; i < p.passive.size(); ++i) {
      if (std::ranges::find(original.active, p.passive[i]) != original.active.end()) driven.push_back(i);
    }
    if (driven.empty()) return force;
    const bool all = driven.size() == original.active.size();
    const auto tau = symbols_.block(all ? "tau_a" : "tau_d", static_cast<int>(driven.size()), "N m or N",
                                    "torques of the torque-driven coordinates");
    for (std::size_t i = 0; i < driven.size(); ++i) force[driven[i]] = tau[i];
    return force;
  }

  std::vector<Expr> accelerations(const Reduced& of, const ReducedDynamics& d,
                                  const std::vector<Expr>& nu_dot) const {
    std::vector<Expr> v = d.bias_acceleration;
    const std::vector<Expr> h = of.reduction->kernel().H * nu_dot;
    for (std::size_t i = 0; i < h.size(); ++i) v[static_cast<std::size_t>(of.partition.passive[i])] += h[i];
    return v;
  }

  void derive_reduced_dynamics() {
    const bool reduced = wanted("reduced_dynamics"), forward = wanted("forward_dynamics"),
               split = wanted("split_dynamics");
    if (!reduced && !forward && !split) return;
    std::vector<Route> reduced_routes, forward_routes, split_routes;
    const std::vector<Expr> force = driving_force(motion_partition_);
    for (const bool project : {true, false}) {
      const std::string name = project ? "projected recursion" : "all blocks, (66)-(68)";
      const ReducedDynamics d = reduced_dynamics(motion_, nu_, r_a_dot_, r_a_ddot_, force, project);
      reduced_routes.push_back(
          {name,
           {block("M_r", "mixed", "reduced mass matrix, symmetric positive definite", d.M_r),
            block("f_r", "mixed", "reduced forces", d.f_r)}});
      if (forward) {
        tape_.section("reduced accelerations");
        std::vector<Expr> nu_dot;
        if (motion_.k() > 0) nu_dot = solve_symmetric(d.M_r, {d.f_r}).front();
        tape_.section("passive accelerations");
        const std::vector<Expr> v_dot = accelerations(motion_, d, nu_dot);
        std::vector<OutputBlock> outputs = {block("nu_dot", "mixed", "derivative of nu", nu_dot)};
        for (OutputBlock& b :
             split_passive(motion_partition_, picked(v_dot, motion_partition_.passive), "dot"))
          outputs.push_back(std::move(b));
        forward_routes.push_back({name, std::move(outputs)});
      }
      if (split) split_routes.push_back({name, split_blocks(d)});
    }
    if (reduced)
      emit("reduced_dynamics", "Reduced dynamics, eq. (23): M_r nu_dot = f_r, by (66)-(68).", reduced_routes);
    if (split)
      emit("split_dynamics",
           "Forward dynamics by blocks, eqs. (4)-(5), of external and internal reduced velocities.",
           split_routes);
    if (!forward) return;
    const bool replaced = replace_by_articulated_bodies(force, forward_routes);
    emit("forward_dynamics",
         "Forward dynamics of the passive degrees of freedom: eq. (23) solved, then (18).", forward_routes,
         replaced ? "the mass matrix would lose the digits of its small bodies" : "", !replaced);
  }

  /// Where every route through the mass matrix loses most of its digits at the default parameters, and
  /// articulated bodies do not, they are the only route left.
  bool replace_by_articulated_bodies(const std::vector<Expr>& force, std::vector<Route>& routes) {
    constexpr double poor = 1e-10, gain = 1e-3;
    const Partition& p = motion_partition_;
    if (routes.empty() || !p.active.empty() || motion_.k() != static_cast<int>(p.passive.size()))
      return false;
    std::vector<NodeId> parameters;
    for (const ParameterInfo& info : program_.parameters) parameters.push_back(info.node);
    const auto rounding = [&](const Route& r) {
      return rounding_of(tape_, roots_of(r), parameters, defaults_);
    };
    double least = std::numeric_limits<double>::infinity();
    for (const Route& r : routes) least = std::min(least, rounding(r));
    if (least < poor) return false;  // before anything else is derived, so that other models stay as they are
    const std::vector<Expr> none;
    const State<Expr> state =
        symbols_.moving(merged(p, motion_.reduction->velocities(none, nu_), none));  // nu are velocities
    if (!is_rigid_tree(mechanism_, state)) return false;
    std::vector<Expr> torque(static_cast<std::size_t>(mechanism_.coordinates), Expr(0));
    for (std::size_t i = 0; i < p.passive.size(); ++i) {
      if (p.passive[i] >= p.n) torque[static_cast<std::size_t>(p.passive[i] - p.n)] = force[i];
    }
    const std::vector<Expr> v_dot = picked(articulated_accelerations(mechanism_, state, torque), p.passive);
    Route articulated{"articulated bodies", {block("nu_dot", "mixed", "derivative of nu", v_dot)}};
    for (OutputBlock& b : split_passive(p, v_dot, "dot")) articulated.outputs.push_back(std::move(b));
    if (!(rounding(articulated) < gain * least)) return false;
    routes = {std::move(articulated)};
    return true;
  }

  /// Inputs that only this function has, and the directions of the state.
  void prepare_state_jacobian() {
    if (!wants_state_jacobian()) return;
    const auto r_a_dddot =
        symbols_.block("r_a_dddot", motion_partition_.s_a(), "rad/s^3 or m/s^3", "third derivatives of r_a");
    result_->directions =
        state_directions(tape_, symbols_, motion_partition_, nu_, r_a_dot_, r_a_ddot_, r_a_dddot);
  }

  /// The derivative of M_r(x) a = f_r(x) at a fixed, solved for that of a: one inverse dynamics is
  /// differentiated, and M_r is factored once for all directions.
  Matrix<Expr> differentiated_accelerations(bool project) {
    const auto a = symbols_.block("nu_dot", motion_.k(), "mixed", "derivative of nu");
    const std::vector<Expr> force = driving_force(motion_partition_);
    const ReducedDynamics d = reduced_dynamics(motion_, nu_, r_a_dot_, r_a_ddot_, force, project);
    std::vector<Expr> unbalanced =
        picked(dynamics_.inverse_dynamics(symbols_.moving(d.velocity), accelerations(motion_, d, a)),
               motion_partition_.passive);
    for (std::size_t i = 0; i < unbalanced.size(); ++i) unbalanced[i] = force[i] - unbalanced[i];
    std::vector<NodeId> residual;
    for (const Expr& e : motion_.reduction->kernel().H.transposed() * unbalanced)
      residual.push_back(e.id(tape_));
    tape_.section("derivatives of the reduced forces");
    const Matrix<Expr> slopes = derivatives(tape_, residual, result_->directions);
    std::vector<NodeId> nodes;
    for (const Expr& e : slopes.entries()) nodes.push_back(e.id(tape_));
    tape_.section("reduced accelerations");
    const std::vector<Expr> nu_dot = solve_symmetric(d.M_r, {d.f_r}).front();
    nodes = substituted(tape_, nodes, a, nu_dot);
    std::vector<std::vector<Expr>> sides = {d.f_r};
    for (int j = 0; j < slopes.cols(); ++j) {
      sides.emplace_back();
      for (int i = 0; i < slopes.rows(); ++i)
        sides.back().emplace_back(tape_, nodes[static_cast<std::size_t>(i * slopes.cols() + j)]);
    }
    tape_.section("derivatives of the accelerations");
    const auto solved = solve_symmetric(d.M_r, sides);
    Matrix<Expr> result(slopes.rows(), slopes.cols());
    for (int j = 0; j < slopes.cols(); ++j) {
      for (int i = 0; i < slopes.rows(); ++i)
        result(i, j) = solved[static_cast<std::size_t>(j + 1)][static_cast<std::size_t>(i)];
    }
    return result;
  }

  void derive_state_jacobian() {
    if (!wants_state_jacobian()) return;
    const auto nodes_of = [&](const std::vector<Expr>& v) {
      std::vector<NodeId> nodes;
      for (const Expr& e : v) nodes.push_back(e.id(tape_));
      return nodes;
    };
    tape_.section("derivatives of the velocities");
    const Matrix<Expr> velocities =
        derivatives(tape_, nodes_of(motion_.reduction->velocities(r_a_dot_, nu_)), result_->directions);
    std::vector<Route> routes;
    const auto add = [&](const std::string& name, const Matrix<Expr>& accelerations) {
      const int rows = velocities.rows() + accelerations.rows(), columns = velocities.cols() - 1;
      Matrix<Expr> by_state(rows, columns);
      std::vector<Expr> by_time;
      for (int i = 0; i < rows; ++i) {
        const auto entry = [&](int j) {
          return i < velocities.rows() ? velocities(i, j) : accelerations(i - velocities.rows(), j);
        };
        for (int j = 0; j < columns; ++j) by_state(i, j) = entry(j);
        by_time.push_back(entry(columns));
      }
      routes.push_back(
          {name,
           {block("rates_x", "mixed",
                  "rows (eta, r_p_dot, nu_dot), columns (twist of the pose in body axes, r_p, "
                  "nu); torque-driven coordinates behind the passive ones",
                  by_state),
            block("rates_t", "mixed", "derivative by time, the motion of r_a going on", by_time)}});
    };
    if (motion_.k() == 0) {
      add("kinematics", Matrix<Expr>(0, velocities.cols()));
    } else {
      for (const bool project : {true, false})
        add(project ? "residual of the projected recursion" : "residual, (66)-(68)",
            differentiated_accelerations(project));
      for (const Function& f : program_.functions) {
        if (f.name != prefix_ + "forward_dynamics") continue;
        tape_.section("derivatives of the accelerations");
        add("derivative of forward_dynamics",
            derivatives(tape_, f.outputs.front().nodes, result_->directions));
      }
    }
    emit("state_jacobian",
         "Derivatives of the rates of the state (eta, r_p_dot, nu_dot) by the state and by time, exact.",
         routes);
  }

  /// (4)-(5), where H is block triangular with both an external and an internal part.
  std::vector<OutputBlock> split_blocks(const ReducedDynamics& d) {
    const Matrix<Expr>& H = motion_.reduction->kernel().H;
    std::vector<int> external, internal;
    for (int c = 0; c < H.cols(); ++c) {
      bool shape = false;
      for (int i = motion_partition_.n; i < H.rows(); ++i) shape = shape || !H(i, c).is_zero();
      (shape ? internal : external).push_back(c);
    }
    if (external.empty() || internal.empty()) return {};
    const auto e = [&](const std::vector<int>& i, const std::vector<int>& j) { return d.M_r.block(i, j); };
    const Matrix<Expr> M_pr = e(internal, external);
    const std::vector<Expr> f = picked(d.f_r, external);
    const std::vector<Expr> Q = picked(d.f_r, internal);
    std::vector<std::vector<Expr>> sides = {Q};
    for (std::size_t j = 0; j < external.size(); ++j) {
      sides.emplace_back();
      for (int i = 0; i < M_pr.rows(); ++i) sides.back().push_back(M_pr(i, static_cast<int>(j)));
    }
    tape_.section("modified blocks");
    const auto solved = solve_symmetric(e(internal, internal), sides);  // m_pp,r^-1 (Q, M_p,r)
    Matrix<Expr> coupling(M_pr.rows(), M_pr.cols());
    for (int i = 0; i < M_pr.rows(); ++i) {
      for (int j = 0; j < M_pr.cols(); ++j)
        coupling(i, j) = solved[static_cast<std::size_t>(1 + j)][static_cast<std::size_t>(i)];
    }
    const Matrix<Expr> M_tilde = e(external, external) - M_pr.transposed() * coupling;
    std::vector<Expr> F_tilde = f;
    const std::vector<Expr> shift = M_pr.transposed() * solved[0];
    for (std::size_t i = 0; i < F_tilde.size(); ++i) F_tilde[i] -= shift[i];
    const std::vector<Expr> nu_e_dot = solve_symmetric(M_tilde, {F_tilde}).front();
    std::vector<Expr> Q_tilde = Q;
    const std::vector<Expr> reaction = M_pr * nu_e_dot;
    for (std::size_t i = 0; i < Q_tilde.size(); ++i) Q_tilde[i] -= reaction[i];
    return {block("M_tilde_r", "mixed", "modified external mass matrix of (4)", M_tilde),
            block("F_tilde_r", "mixed", "modified external forces of (4)", F_tilde),
            block("m_pp_r", "mixed", "internal mass matrix of (5)", e(internal, internal)),
            block("Q_tilde_p_r", "mixed", "modified internal forces of (5)", Q_tilde)};
  }

  /// Residual M v_dot - (f, Q) - tau (n + s) at given accelerations.
  void derive_torques_and_multipliers() {
    const bool torques = wanted("inverse_torques") && motion_partition_.s_a() > 0;
    const bool multipliers = wanted("multipliers") && !mechanism_.rows.empty();
    if (!torques && !multipliers) return;
    const KinematicReduction& k = *motion_.reduction;
    const Partition& p = motion_partition_;
    const auto nu_dot = symbols_.block("nu_dot", motion_.k(), "mixed", "derivative of nu");
    const int redundant = k.static_basis().cols();
    const auto lambda_stat = symbols_.block(
        "lambda_stat", redundant, "mixed",
        "coordinates of the static loading in lambda_stat_basis; zero is the generalised inverse's share");
    const std::vector<Expr> force = driving_force(p);
    tape_.section("admissible velocities");
    const std::vector<Expr> passive = k.velocities(r_a_dot_, nu_);
    const std::vector<Expr> velocity = merged(p, passive, r_a_dot_);
    const State<Expr> state = symbols_.moving(velocity);
    std::vector<Expr> bias;
    if (!mechanism_.rows.empty()) bias = dynamics_.constraints(state).second;
    tape_.section("passive accelerations");
    std::vector<Expr> v_p = k.drift(r_a_dot_, nu_, bias, symbols_.motion(velocity));
    const std::vector<Expr> imposed = k.kernel().J * r_a_ddot_;
    const std::vector<Expr> reduced = k.kernel().H * nu_dot;
    for (std::size_t i = 0; i < v_p.size(); ++i) v_p[i] += imposed[i] + reduced[i];
    const std::vector<Expr> residual = dynamics_.inverse_dynamics(state, merged(p, v_p, r_a_ddot_));
    std::vector<Expr> passive_residual = picked(residual, p.passive);
    for (std::size_t i = 0; i < force.size(); ++i) passive_residual[i] -= force[i];
    if (torques) {
      tape_.section("torques");
      std::vector<Expr> tau = picked(residual, p.active);
      const std::vector<Expr> carried = k.kernel().J.transposed() * passive_residual;
      const std::vector<Expr> loading = k.rows().B.transposed() * (k.static_basis() * lambda_stat);
      for (std::size_t i = 0; i < tau.size(); ++i) tau[i] += carried[i] - loading[i];
      emit("inverse_torques", "Torques of the active joints, eq. (27) with the sign of lambda_stat of (26).",
           {{"projected recursion", {block("tau_a", "N m or N", "torques conjugate to r_a", tau)}}});
    }
    if (multipliers) {
      tape_.section("multipliers");
      emit("multipliers", "Constraint forces, eq. (26). They grow without bound where (A, B_p) loses rank.",
           {{"projected recursion",
             {block("lambda", "mixed", "one for each row of eq. (2)",
                    k.multipliers(passive_residual, lambda_stat))}}});
    }
  }

  void derive_compatibility() {
    if (!wanted("compatibility") || motion_.ranks.m <= motion_.ranks.m_locked) return;
    const KinematicReduction& k = *motion_.reduction;
    tape_.section("compatibility");
    const Matrix<Expr> Nt = k.static_basis().transposed();
    const std::vector<Expr> velocity = Nt * (k.rows().B * r_a_dot_);
    const State<Expr> state =
        symbols_.moving(merged(motion_partition_, k.velocities(r_a_dot_, nu_), r_a_dot_));
    std::vector<Expr> sum = k.rows().B * r_a_ddot_;
    const std::vector<Expr> bias = dynamics_.constraints(state).second;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += bias[i];
    emit("compatibility",
         "Conditions on the imposed motion of an over-constrained system (remark 3): both residuals must "
         "vanish.",
         {{"kernel",
           {block("velocity_residual", "mixed", "N^T B_a r_a_dot", velocity),
            block("acceleration_residual", "mixed", "N^T (B_a r_a_ddot + bias)", Nt * sum)}}});
  }

  /// Eq. (9): every active joint by torque, in charts of its own.
  void derive_torque_driven() {
    const std::vector<std::string> family = {"torque_driven_dynamics", "torque_driven_kinematics",
                                             "torque_driven_velocities", "torque_driven_multipliers"};
    if (std::ranges::none_of(family, [this](const std::string& f) { return wanted(f); }) ||
        partition_of(model_).s_a() == 0 || !request_.torque_driven.empty())
      return;
    torque_driven_ = reduce(partition_of(model_, {"*"}));
    Reduced& all = torque_driven_;
    atlas_ = &all.atlas;
    const auto w =
        symbols_.block("w", all.k(), "mixed", "reduced velocities with r_a free: " + meaning_of_nu(all));
    for (std::size_t c = 0; c < all.atlas.charts.size(); ++c) {
      prefix_ = chart_prefix(c);
      chart_ = c;
      all.reduction = all.atlas.charts[c].get();
      derive_torque_driven(all, w, family);
    }
    prefix_.clear();
    chart_ = 0;
    if (all.atlas.charts.size() > 1)
      emit_quality(all.atlas, "torque_driven_chart_quality", "w", family[2], family[1]);
    atlas_ = &motion_.atlas;
    result_->torque_driven = report(all);
  }

  void derive_torque_driven(const Reduced& all, const std::vector<Expr>& w,
                            const std::vector<std::string>& family) {
    const KinematicReduction& k = *all.reduction;
    if (wanted(family[1])) {
      std::vector<OutputBlock> outputs = split_passive(all.partition, k.velocities({}, w), "");
      outputs.push_back(block("H_w", "mixed", "kernel of (A, B_p, B_a), rows (eta, r_p, r_a)", k.kernel().H));
      emit(family[1], "All velocities from the reduced ones, active joints free.", {{"kernel", outputs}});
    }
    if (wanted(family[2])) {
      std::vector<Expr> passive = eta_input();
      for (const Expr& e : r_p_dot_input()) passive.push_back(e);
      for (const Expr& e : r_a_dot_) passive.push_back(e);
      emit(family[2], "Reduced velocities of admissible ones, active joints free.",
           {{"kernel", {block("w", "mixed", "reduced velocities", k.reduced_velocities(passive, {}))}}});
    }
    const std::vector<Expr> force = driving_force(all.partition);
    if (wanted(family[0]) && all.k() > 0) {
      std::vector<Route> routes;
      for (const bool project : {true, false}) {
        const ReducedDynamics d = reduced_dynamics(all, w, {}, {}, force, project);
        tape_.section("reduced accelerations");
        const std::vector<Expr> w_dot = solve_symmetric(d.M_r, {d.f_r}).front();
        tape_.section("accelerations");
        std::vector<OutputBlock> outputs = {block("w_dot", "mixed", "derivative of w", w_dot)};
        for (OutputBlock& b :
             split_passive(all.partition, picked(accelerations(all, d, w_dot), all.partition.passive), "dot"))
          outputs.push_back(std::move(b));
        routes.push_back({project ? "projected recursion" : "all blocks, (66)-(68)", std::move(outputs)});
      }
      emit(
          family[0],
          "Forward dynamics with the torques given, eq. (9): every constraint holds, compatibility included.",
          routes);
    }
    if (wanted(family[3]) && !mechanism_.rows.empty()) {
      const auto w_dot = symbols_.block("w_dot", all.k(), "mixed", "derivative of w");
      const ReducedDynamics d = reduced_dynamics(all, w, {}, {}, force, true);
      std::vector<Expr> residual =
          picked(dynamics_.inverse_dynamics(symbols_.moving(d.velocity), accelerations(all, d, w_dot)),
                 all.partition.passive);
      for (std::size_t i = 0; i < residual.size(); ++i) residual[i] -= force[i];
      tape_.section("multipliers");
      emit(family[3], "Constraint forces with the torques given, least norm.",
           {{"projected recursion",
             {block(
                 "lambda", "mixed", "one for each row of eq. (2)",
                 k.multipliers(residual, std::vector<Expr>(static_cast<std::size_t>(k.static_basis().cols()),
                                                           Expr(0))))}}});
    }
  }

  void derive_position_conditions() {
    if (!wanted("position_conditions") || model_.positions.empty()) return;
    tape_.section("conditions on the position");
    const auto [values, slopes] = dynamics_.conditions(symbols_.position());
    emit("position_conditions",
         "Conditions on the position that the constraint rows keep: zero, or their value where the contact "
         "began.",
         {{"recursion",
           {block("Phi", "m or 1", "values", values),
            block("Phi_q", "mixed",
                  "derivatives by the velocities (twist in the reference body's axes, coordinates in "
                  "declared order)",
                  slopes)}}});
  }

  void derive_energies() {
    if (!wanted("energies")) return;
    const auto e = dynamics_.energies(symbols_.moving(full_velocity()));
    emit("energies",
         "Kinetic energy, potential of gravity (zero at the world's origin), elastic and other potential "
         "energy; power lost and power of applied forces.",
         {{"recursion",
           {block("kinetic", "J", "kinetic energy", std::vector{e.kinetic}),
            block("gravity", "J", "potential of gravity", std::vector{e.gravity}),
            block("elastic", "J", "springs, modes and the described potential", std::vector{e.elastic}),
            block("dissipated_power", "W", "velocities times the gradient of the dissipation function",
                  std::vector{e.dissipated_power}),
            block("applied_power", "W", "of the described forces and wrenches",
                  std::vector{e.applied_power})}}});
  }

  void derive_poses() {
    if (!wanted("body_poses")) return;
    std::vector<Mat3<Expr>> R;
    std::vector<Vec3<Expr>> p;
    FreeDynamics<Expr>(described_).poses(symbols_.position(), R, p);  // also of bodies that are merged
    std::vector<OutputBlock> outputs;
    for (std::size_t b = 0; b < R.size(); ++b) {
      Matrix<Expr> rotation(3, 3);
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) rotation(i, j) = R[b](i, j);
      }
      outputs.push_back(
          block("R_" + model_.bodies[b].name, "1", "orientation in the world, row-major", rotation));
      outputs.push_back(block("p_" + model_.bodies[b].name, "m", "origin in the world",
                              std::vector{p[b].x, p[b].y, p[b].z}));
    }
    emit("body_poses", "Poses of the body frames in the world, eq. (70).", {{"recursion", outputs}});
  }

  void note_header() {
    if (request_.optimise != OptimiseFor::balanced)
      program_.notes.push_back(fmt::format("optimised for {}", anholon::name(request_.optimise)));
    const RankAnalysis& r = motion_.ranks;
    program_.notes.push_back(fmt::format(
        "group {}: n = {}, s_p = {}, s_a = {}, rows = {}, m = {}, m_locked = {}", name(model_.group),
        motion_partition_.n, motion_partition_.s_p(), motion_partition_.s_a(), r.rows, r.m, r.m_locked));
    program_.notes.push_back("Table I: " + r.table_I_class(motion_partition_));
    const auto& charts = motion_.atlas.charts;
    for (std::size_t c = 0; c < charts.size(); ++c)
      program_.notes.push_back((charts.size() > 1 ? fmt::format("chart {}: ", c + 1) : "kernel: ") +
                               charts[c]->kernel().description);
    if (charts.size() > 1)
      program_.notes.push_back(
          "no basis serves everywhere: functions that know nu are there once for each chart, in namespaces "
          "chart1, chart2, ...; those without such a namespace are of chart 1; choose_chart() compares and "
          "is "
          "the only function that branches");
  }

  const Model& model_;
  const DeriveRequest& request_;
  std::unique_ptr<Derivation> result_;
  Program& program_;
  Tape& tape_;
  Partition motion_partition_;
  ProgramSymbols symbols_;
  MechanismDescription description_;
  Mechanism<Expr> described_;  // every body as the model has it
  Mechanism<Expr> mechanism_;  // bodies on fixed and locked joints merged
  FreeDynamics<Expr> dynamics_;
  std::vector<SampleState> samples_;
  std::vector<std::string> names_;
  std::vector<Exact> defaults_;
  Reduced motion_, torque_driven_;
  std::string prefix_;                  // of the names of functions: the chart
  const KernelAtlas* atlas_ = nullptr;  // that chart_ belongs to; null before there is one
  std::size_t chart_ = 0;
  std::vector<NodeId> parameter_nodes_;
  struct Traced {
    std::string function;
    std::vector<Candidate> candidates;
    std::size_t best;
    std::size_t first_report;  // of the candidates
    const KernelAtlas* atlas;
    std::size_t chart;
  };
  std::vector<Traced> traced_;
  std::vector<Expr> nu_, r_a_dot_, r_a_ddot_;
};

}  // namespace

std::string chart_prefix(std::size_t chart) { return chart == 0 ? "" : fmt::format("chart{}::", chart + 1); }

OperationCount operations_per_call(const Program& program, const std::vector<NodeId>& roots) {
  const Tape& tape = program.tape;
  std::vector<char> on_parameters(tape.size(), 0);
  for (const ParameterInfo& p : program.parameters) on_parameters[p.node] = 1;
  std::vector<NodeId> prepared;
  for (const NodeId id : tape.reachable(roots)) {
    const Node& n = tape.node(id);
    const int arity = info(n.op).arity;
    if (arity == 0) continue;
    const auto fixed = [&](NodeId x) { return on_parameters[x] != 0 || tape.is_constant(x); };
    if (!fixed(n.a) || (arity == 2 && !fixed(n.b))) continue;
    on_parameters[id] = 1;
    prepared.push_back(id);
  }
  return count_operations(tape, roots, prepared);
}

std::unique_ptr<Derivation> derive(const Model& model, const DeriveRequest& request) {
  return Deriver(model, request).run();
}

}  // namespace anholon
