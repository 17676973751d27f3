// SPDX-License-Identifier: GPL-2.0-or-later
// `check` for a robot from a robot file: what was read, merged, dropped, snapped and assumed.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "anholon/free_dynamics.hpp"
#include "cli/common.hpp"
#include "describe/mechanise.hpp"
#include "reduce/decompositions.hpp"
#include "reduce/samples.hpp"

namespace anholon::cli {
namespace {

constexpr int sampled_states = 100;

struct JointLine {
  std::string coordinate, kind, link, range;
};

/// Mass matrix over the working range: its condition number is infinite where it is not positive definite.
struct Conditioning {
  double worst = 0;
  std::vector<double> mass;  // of each body, kg
};

std::string kind_of(const BodyDescription& body) {
  constexpr std::array<const char*, 4> kinds = {"fixed", "revolute", "prismatic", "helical"};
  return kinds[static_cast<std::size_t>(body.joint.kind)];
}

std::string number(const Exact& x) { return fmt::format("{:.5g}", x.to_double()); }

std::vector<JointLine> joint_lines(const Model& model) {
  std::vector<JointLine> lines;
  std::vector<std::string> seen;
  for (const BodyDescription& body : model.bodies) {
    if (body.parent < 0 || body.joint.kind == JointKind::fixed) continue;
    const auto c = std::ranges::find(model.coordinates, body.joint.coordinate, &Coordinate::name);
    const auto index = static_cast<std::size_t>(c - model.coordinates.begin());
    const bool follows = std::ranges::find(seen, body.joint.coordinate) != seen.end() ||
                         c == model.coordinates.end() ||
                         body.joint.displacement.id(*model.tape) != model.symbols.r[index];
    seen.push_back(body.joint.coordinate);
    lines.push_back({body.joint.coordinate, kind_of(body), body.name,
                     follows ? "mimics"
                             : fmt::format("[{}, {}] {}", number(c->lower), number(c->upper),
                                           c->is_angle ? "rad" : "m")});
  }
  return lines;
}

/// "tool into hand" for every link on a fixed joint.
std::vector<std::string> merged_links(const Model& model) {
  std::vector<std::string> merged;
  for (const BodyDescription& body : model.bodies) {
    if (body.parent < 0 || body.joint.kind != JointKind::fixed) continue;
    const BodyDescription* into = &body;
    while (into->parent >= 0 && into->joint.kind == JointKind::fixed)
      into = &model.bodies[static_cast<std::size_t>(into->parent)];
    merged.push_back(fmt::format("{} into {}", body.name, into->name));
  }
  return merged;
}

Conditioning conditioning(const Model& model) {
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  const Mechanism<double> mechanism = mechanise<double>(describe_mechanism(model), parameters);
  FreeDynamics<double> dynamics(mechanism);
  Conditioning result;
  for (const Body<double>& b : mechanism.bodies) result.mass.push_back(b.mass);
  SampleSource source;
  for (int i = 0; i < sampled_states; ++i) {
    const State<Exact> exact = random_state(model, source);
    State<double> state;
    for (std::size_t k = 0; k < 9; ++k) state.R.m[k] = exact.R.m[k].to_double();
    for (const Exact& r : exact.r) state.r.push_back(r.to_double());
    state.r_dot.assign(state.r.size(), 0);
    const Matrix<double> M = dynamics.mass_matrix(state);
    if (M.rows() == 0) return result;
    const Eigen::VectorXd values = eigenvalues(to_eigen(M));
    const double least = values(0), most = values(values.size() - 1);
    const bool definite = least > 1e-14 * most;
    result.worst = std::max(result.worst, definite ? most / least : std::numeric_limits<double>::infinity());
  }
  return result;
}

}  // namespace

int check_tree(const CheckOptions& options, const Model& model) {
  const std::vector<JointLine> joints = joint_lines(model);
  const std::vector<std::string> merged = merged_links(model);
  const Conditioning state = conditioning(model);
  double mass = 0;
  for (const double m : state.mass) mass += m;
  const auto n = free_components(model.group).size();
  const std::size_t s = model.coordinates.size();

  if (options.json) {
    nlohmann::ordered_json j;
    j["schema"] = "anholon.check_tree/1";
    j["model"] = model.name;
    j["source"] = model.file;
    j["group"] = name(model.group);
    j["sizes"] = {{"n", n}, {"s", s}, {"links", model.bodies.size()}, {"merged", merged.size()}};
    j["mass"] = mass;
    for (const JointLine& line : joints)
      j["joints"].push_back(
          {{"coordinate", line.coordinate}, {"kind", line.kind}, {"link", line.link}, {"range", line.range}});
    j["merged"] = merged;
    if (std::isfinite(state.worst)) j["mass_matrix"] = {{"worst_condition", state.worst}};
    j["mass_matrix"]["positive_definite"] = std::isfinite(state.worst);
    j["notes"] = model.notes;
    fmt::print("{}\n", j.dump(1));
    return ok;
  }
  fmt::print("{}{}\n", model.name, model.title == model.name ? "" : ": " + model.title);
  fmt::print("  source                {}, sha256 {}\n", model.file, model.sha256.substr(0, 16));
  fmt::print("  reference body        {}, {}\n", model.bodies[0].name,
             n == 0 ? "fixed to the world" : fmt::format("free in {} (n = {})", name(model.group), n));
  fmt::print("  links                 {}, {} of them merged on fixed joints; {:.6g} kg in all\n",
             model.bodies.size(), merged.size(), mass);
  fmt::print("  coordinates           s = {}, all driven\n", s);
  fmt::print("  gravity               ({}, {}, {}) m/s^2\n",
             number(model.gravity[0].constant_value().value_or(0)),
             number(model.gravity[1].constant_value().value_or(0)),
             number(model.gravity[2].constant_value().value_or(0)));
  if (!model.parameters.empty())
    fmt::print("  parameters            {} inertial figures\n", model.parameters.size());
  fmt::print("  mass matrix           {} at {} states of the working range\n",
             n + s == 0 ? "empty, as nothing moves,"
             : std::isfinite(state.worst)
                 ? fmt::format("positive definite, condition {:.3g} at worst", state.worst)
                 : "SINGULAR (some joint moves no inertia)",
             sampled_states);
  std::size_t width = 5;
  for (const JointLine& line : joints) width = std::max(width, line.coordinate.size());
  for (const JointLine& line : joints)
    fmt::print("  joint                 {:{}s}  {:9s}  {:24s}  moves {}\n", line.coordinate, width, line.kind,
               line.range, line.link);
  for (const std::string& line : merged) fmt::print("  merged                {}\n", line);
  for (const std::string& note : model.notes) {
    const std::size_t colon = note.find(": ");
    const bool has_kind = colon < 12;
    fmt::print("  {:20s}  {}\n", has_kind ? note.substr(0, colon) : "note",
               has_kind ? note.substr(colon + 2) : note);
  }
  return ok;
}

}  // namespace anholon::cli
