// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/accuracy/rounding_error.hpp"

#include <cln/float.h>
#include <cln/real.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "tape/interpret.hpp"

namespace anholon {
namespace {

constexpr double ulp = std::numeric_limits<double>::epsilon();
constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr unsigned digits = 40;

/// A double whose every operation is rounded correctly.
struct Rounded {
  double x;
  explicit Rounded(double value = 0) : x(value) {}

  friend Rounded operator+(Rounded a, Rounded b) { return Rounded(a.x + b.x); }
  friend Rounded operator-(Rounded a, Rounded b) { return Rounded(a.x - b.x); }
  friend Rounded operator*(Rounded a, Rounded b) { return Rounded(a.x * b.x); }
  friend Rounded operator/(Rounded a, Rounded b) { return Rounded(a.x / b.x); }
  friend Rounded operator-(Rounded a) { return Rounded(-a.x); }
  friend Rounded sqrt(Rounded a) { return Rounded(std::sqrt(a.x)); }
  friend Rounded abs(Rounded a) { return Rounded(std::abs(a.x)); }
  friend Rounded sign(Rounded a) { return Rounded(a.x > 0 ? 1 : a.x < 0 ? -1 : 0); }
  friend Rounded sin(Rounded a) { return from_exact(Op::sin, a); }
  friend Rounded cos(Rounded a) { return from_exact(Op::cos, a); }
  friend Rounded tan(Rounded a) { return from_exact(Op::tan, a); }
  friend Rounded asin(Rounded a) { return from_exact(Op::asin, a); }
  friend Rounded acos(Rounded a) { return from_exact(Op::acos, a); }
  friend Rounded atan2(Rounded a, Rounded b) { return from_exact(Op::atan2, a, b); }
  friend Rounded exp(Rounded a) { return from_exact(Op::exp, a); }
  friend Rounded log(Rounded a) { return from_exact(Op::log, a); }
  friend Rounded tanh(Rounded a) { return from_exact(Op::tanh, a); }

 private:
  static Rounded from_exact(Op op, Rounded a, Rounded b = Rounded()) {
    if (!std::isfinite(a.x) || !std::isfinite(b.x)) return Rounded(infinite - infinite);
    try {
      return Rounded(apply(op, Exact::from_double(a.x), Exact::from_double(b.x)).to_double());
    } catch (const std::domain_error&) {
      return Rounded(infinite - infinite);
    }
  }
};

/// Near enough for an error or a scale, and quicker than the correct rounding of Exact::to_double().
double about(const Exact& x) { return cln::double_approx(x.value()); }

/// Numbers with the working digits: arithmetic on rationals would grow without use.
Exact as_float(double x) { return Exact::from_double(x).as_float(); }
struct FloatConstant {
  Exact operator()(const Exact& value) const { return value.as_float(); }
};
struct RoundedConstant {
  Rounded operator()(const Exact& value) const { return Rounded(value.to_double()); }
};

/// Largest error of a block and largest value, at one state.
struct BlockError {
  double error = 0, scale = 0;
};

double median_of(std::vector<double> x) {
  const auto middle = x.begin() + static_cast<std::ptrdiff_t>(x.size() / 2);
  std::ranges::nth_element(x, middle);
  return *middle;
}

}  // namespace

std::string RoundingError::text() const {
  if (!is_measured()) return fmt::format("{:>9s} {:>9s}", "-", "-");
  return fmt::format("{:>9.3g} {:>9.3g}", median, worst);
}

std::vector<RoundingError> rounding_errors(const Tape& tape,
                                           const std::vector<std::vector<OutputBlock>>& programs,
                                           const std::vector<std::vector<double>>& states) {
  const WorkingDigits precision(digits);
  std::vector<NodeId> roots;
  for (const auto& program : programs) {
    for (const OutputBlock& b : program) roots.insert(roots.end(), b.nodes.begin(), b.nodes.end());
  }
  Interpreter<Exact> exactly(tape, roots, FloatConstant{});
  Interpreter<Rounded> in_double(tape, roots, RoundedConstant{});

  std::vector<std::vector<BlockError>> blocks;  // one for each block of each program, over the states
  for (const std::vector<double>& state : states) {
    std::vector<Exact> expected;
    try {
      std::vector<Exact> inputs;
      for (const double x : state) inputs.push_back(as_float(x));
      expected.assign(roots.size(), Exact(0));
      exactly(inputs, expected);
    } catch (const std::domain_error&) {
      continue;
    }
    std::vector<Rounded> inputs, got(roots.size());
    for (const double x : state) inputs.emplace_back(x);
    in_double(inputs, got);
    std::size_t root = 0, block = 0;
    for (const auto& program : programs) {
      for (const OutputBlock& b : program) {
        BlockError e;
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
    for (std::size_t b = 0; b < program.size() && block < blocks.size(); ++b, ++block) {
      std::vector<double> scales;
      for (const BlockError& e : blocks[block]) scales.push_back(e.scale);
      const double typical = median_of(scales);
      of_state.resize(scales.size(), 0.0);
      for (std::size_t s = 0; s < scales.size(); ++s) {
        const double scale = std::max({scales[s], typical, std::numeric_limits<double>::min()});
        of_state[s] = std::max(of_state[s], blocks[block][s].error / scale / ulp);
      }
    }
    RoundingError e;
    if (!of_state.empty()) e = {median_of(of_state), *std::ranges::max_element(of_state)};
    result.push_back(e);
  }
  return result;
}

std::vector<double> reproducible_values(const Tape& tape, const std::vector<NodeId>& nodes,
                                        const std::vector<double>& inputs) {
  const WorkingDigits precision(digits);
  std::vector<Rounded> in, out(nodes.size());
  for (const double x : inputs) in.emplace_back(x);
  Interpreter<Rounded>(tape, nodes, RoundedConstant{})(in, out);
  std::vector<double> result;
  for (const Rounded& x : out) result.push_back(x.x);
  return result;
}

}  // namespace anholon
