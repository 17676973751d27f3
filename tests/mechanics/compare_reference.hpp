// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The comparison of an answer of `evaluate` with a reference file, quantity by quantity. Error of a quantity
// at a state: the largest difference over the natural scale, which is the largest magnitude of that quantity
// at that state, but not below its median over the states. Constrained quantities may lose the condition
// number of (A, B_p) near a singular configuration: there the tolerance is multiplied by it.

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "number/exact.hpp"

namespace anholon::test {

using Json = nlohmann::ordered_json;

inline Json read_reference(const std::string& name) {
  std::ifstream stream(std::string(ANHOLON_SOURCE_DIR) + "/tests/reference/" + name + ".json");
  return Json::parse(stream);
}

inline Exact number(const Json& json) {
  return Exact::from_decimal(json.is_string() ? json.get<std::string>() : json.dump());
}

/// All numbers of a nested list in order; nothing where one is not finite.
inline std::optional<std::vector<Exact>> flat(const Json& json) {
  std::vector<Exact> numbers;
  if (json.is_array()) {
    for (const Json& item : json) {
      const auto part = flat(item);
      if (!part) return std::nullopt;
      numbers.insert(numbers.end(), part->begin(), part->end());
    }
    return numbers;
  }
  try {
    return std::vector{number(json)};
  } catch (const std::invalid_argument&) {
    return std::nullopt;  // "null" is what JSON makes of a NaN
  }
}

inline const Json* dig(const Json& outputs, const std::string& path) {
  const Json* at = &outputs;
  for (std::size_t from = 0; from <= path.size();) {
    const std::size_t dot = std::min(path.find('.', from), path.size());
    const auto found = at->find(path.substr(from, dot - from));
    if (found == at->end()) return nullptr;
    at = &*found;
    from = dot + 1;
  }
  return at;
}

inline Exact largest(const std::vector<Exact>& values) {
  Exact size = 0;
  for (const Exact& x : values) size = std::max(size, abs(x));
  return size;
}

/// Largest over smallest singular value of (A, B_p), those that vanish aside.
inline Exact condition(const Json& outputs) {
  Exact greatest = 0, least = 0;
  for (const Json& item : outputs.at("singular_values_of_A_B_p")) {
    const Exact sigma = number(item);
    if (sigma < Exact::from_decimal("1e-12")) continue;
    greatest = std::max(greatest, sigma);
    least = least.is_zero() ? sigma : std::min(least, sigma);
  }
  return least.is_zero() ? Exact(1) : greatest / least;
}

/// What is wrong with a quantity, and the worst error over what is allowed.
struct Comparison {
  std::string quantity;
  std::string fault;  // empty where the quantity is present everywhere
  double worst_of_allowed = 0;
  double error = 0;  // at the worst state
  std::string where;
};

inline const std::vector<std::string>& basis_free_quantities() {
  static const std::vector<std::string> names = {"M_eta_eta",
                                                 "M_p",
                                                 "M_a",
                                                 "m_pp",
                                                 "m_pa",
                                                 "m_aa",
                                                 "f",
                                                 "Q_p",
                                                 "Q_a",
                                                 "A",
                                                 "B_p",
                                                 "B_a",
                                                 "constraint_bias_Gdot_v",
                                                 "kernel_projector",
                                                 "given_r_a.eta_dot",
                                                 "given_r_a.r_p_ddot",
                                                 "given_r_a.lambda_min_norm",
                                                 "given_r_a.tau_a",
                                                 "given_tau_a.eta_dot",
                                                 "given_tau_a.r_p_ddot",
                                                 "given_tau_a.r_a_ddot",
                                                 "given_tau_a.lambda_min_norm",
                                                 "energy.kinetic",
                                                 "energy.gravity",
                                                 "energy.elastic",
                                                 "energy.total",
                                                 "energy.dissipated_power",
                                                 "energy.actuator_power"};
  return names;
}

inline std::vector<Comparison> compare(const Json& reference, const Json& answer, const Exact& tolerance) {
  const Exact noise = Exact::from_decimal("1e-30");  // the zeros of the references carry noise below this
  const Json& expected = reference.at("states");
  const Json& got = answer.at("states");
  std::vector<Comparison> result;
  for (const std::string& quantity : basis_free_quantities()) {
    std::vector<std::vector<Exact>> wants;
    std::vector<Exact> sizes;
    std::vector<std::size_t> states;
    for (std::size_t s = 0; s < expected.size(); ++s) {
      const Json* want = dig(expected[s].at("outputs"), quantity);
      if (want == nullptr || flat(*want)->empty()) continue;
      states.push_back(s);
      wants.push_back(*flat(*want));
      if (const Exact size = largest(wants.back()); size > noise) sizes.push_back(size);
    }
    if (states.empty()) continue;
    std::sort(sizes.begin(), sizes.end());
    const Exact typical = sizes.empty() ? Exact(1) : sizes[sizes.size() / 2];
    const bool constrained = quantity.starts_with("kernel_projector") || quantity.starts_with("given_");
    Comparison& c = result.emplace_back(Comparison{quantity, "", -1, 0, ""});
    for (std::size_t i = 0; i < states.size(); ++i) {
      const Json& state = expected[states[i]];
      const std::string label = state.at("label");
      const Json* have = states[i] < got.size() ? dig(got[states[i]].at("outputs"), quantity) : nullptr;
      const auto values = have == nullptr ? std::nullopt : flat(*have);
      if (!values || values->size() != wants[i].size()) {
        c.fault = (have == nullptr ? "missing at " : "not finite, or of another shape, at ") + label;
        break;
      }
      std::vector<Exact> difference;
      for (std::size_t k = 0; k < values->size(); ++k) difference.push_back((*values)[k] - wants[i][k]);
      const Exact error = largest(difference) / std::max(typical, largest(wants[i]));
      const Exact cond = constrained ? std::max(Exact(1), condition(state.at("outputs"))) : Exact(1);
      const double of_allowed = (error / (tolerance * cond)).to_double();
      if (of_allowed > c.worst_of_allowed)
        c.worst_of_allowed = of_allowed, c.error = error.to_double(), c.where = label;
    }
  }
  return result;
}

}  // namespace anholon::test
