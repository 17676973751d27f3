// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/accuracy/rounding_error.hpp"

#include <cln/float.h>
#include <cln/real.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "optimise/accuracy/natural_scale.hpp"
#include "optimise/accuracy/rounded.hpp"
#include "tape/interpret.hpp"

namespace anholon {
namespace {

constexpr double ulp = std::numeric_limits<double>::epsilon();
constexpr double infinite = std::numeric_limits<double>::infinity();

/// Near enough for an error or a scale, and quicker than the correct rounding of Exact::to_double().
double about(const Exact& x) { return cln::double_approx(x.value()); }

/// Numbers with the working digits: arithmetic on rationals would grow without use.
Exact as_float(double x) { return Exact::from_double(x).as_float(); }
struct FloatConstant {
  Exact operator()(const Exact& value) const { return value.as_float(); }
};

/// Largest error of a block, largest value, and what is allowed, at one state.
struct BlockError {
  double error = 0, scale = 0, allowance = 1;
};

}  // namespace

std::string RoundingError::text() const {
  if (!is_measured()) return fmt::format("{:>9s} {:>9s}", "-", "-");
  return fmt::format("{:>9.3g} {:>9.3g}", median, worst);
}

std::vector<RoundingError> rounding_errors(const Tape& tape,
                                           const std::vector<std::vector<OutputBlock>>& programs,
                                           const std::vector<std::vector<double>>& states,
                                           const std::vector<std::vector<double>>& allowance) {
  const WorkingDigits precision(rounded_digits);
  std::vector<NodeId> roots;
  for (const auto& program : programs) {
    for (const OutputBlock& b : program) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  }
  Interpreter<Exact> exactly(tape, roots, FloatConstant{});
  Interpreter<Rounded> in_double(tape, roots, FromExact<Rounded>{});

  std::vector<std::vector<BlockError>> blocks;  // one for each block of each program, over the states
  std::size_t random = 0;                       // of these states, at the front
  for (std::size_t s = 0; s < states.size(); ++s) {
    const std::vector<double>& state = states[s];
    std::vector<Exact> expected;
    try {
      std::vector<Exact> inputs;
      for (const double x : state) inputs.push_back(as_float(x));
      expected.assign(roots.size(), Exact(0));
      exactly(inputs, expected);
    } catch (const std::domain_error&) {
      continue;
    }
    if (s < measured_states) ++random;
    std::vector<Rounded> inputs, got(roots.size());
    for (const double x : state) inputs.emplace_back(x);
    in_double(inputs, got);
    std::size_t root = 0, block = 0;
    for (const auto& program : programs) {
      for (std::size_t i_block = 0; i_block < program.size(); ++i_block) {
        const OutputBlock& b = program[i_block];
        BlockError e;
        if (!allowance.empty()) e.allowance = allowance[s][i_block];
        for (std::size_t i = 0; i < b.nodes.size(); ++i, ++root) {
          e.scale = std::max(e.scale, std::abs(about(expected[root])));
          e.error = std::max(e.error, std::isfinite(got[root].x)
                                          ? std::abs(about(as_float(got[root].x) - expected[root]))
                                          : infinite);
        }
        if (blocks.size() == block) blocks.emplace_back();
        blocks[block++].push_back(e);
      }
    }
  }
  std::vector<RoundingError> result;
  std::size_t block = 0;
  for (const auto& program : programs) {
    std::vector<double> of_state;
    double excess = 0;
    for (std::size_t b = 0; b < program.size() && block < blocks.size(); ++b, ++block) {
      std::vector<double> scales;
      for (const BlockError& e : blocks[block]) scales.push_back(e.scale);
      scales = natural_scales(scales, random);
      of_state.resize(scales.size(), 0.0);
      for (std::size_t s = 0; s < scales.size(); ++s) {
        const double error = blocks[block][s].error / scales[s] / ulp;
        of_state[s] = std::max(of_state[s], error);
        excess = std::max(excess, error / blocks[block][s].allowance);
      }
    }
    RoundingError e;
    if (!of_state.empty()) e = {median_of(of_state), *std::ranges::max_element(of_state), excess};
    result.push_back(e);
  }
  return result;
}

}  // namespace anholon
