// SPDX-License-Identifier: GPL-2.0-or-later
#include "reduce/configuration_search.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "anholon/lie/so3.hpp"

namespace anholon {
namespace {

constexpr int random_states = 200;
constexpr int descents = 8;      // from the worst of them
constexpr int steps_each = 250;  // for each coordinate that matters

}  // namespace

State<double> rounded_configuration(const State<Exact>& from) {
  State<double> s;
  for (std::size_t i = 0; i < 9; ++i) s.R.m[i] = from.R.m[i].to_double();
  for (int i = 0; i < 3; ++i) s.p[i] = from.p[i].to_double();
  for (const Exact& x : from.r) s.r.push_back(x.to_double());
  s.r_dot.assign(s.r.size(), 0.0);
  s.t = from.t.to_double();
  return s;
}

ConfigurationSearch::ConfigurationSearch(const Model& model, const Values& values) : model_(model) {
  for (int i = 0; i < random_states; ++i)
    states_.push_back(rounded_configuration(random_state(model, source_)));
  // moves one coordinate, or the orientation, of one random state to those of another
  const auto differs = [&values, base = values(states_[0])](const State<double>& s) {
    return values(s) != base;
  };
  for (std::size_t i = 0; i < model_.coordinates.size(); ++i) {
    State<double> moved = states_[0];
    moved.r[i] = states_[1].r[i];
    if (differs(moved)) coordinates_.push_back(i);
  }
  State<double> turned = states_[0];
  turned.R = states_[1].R;
  orientation_ = differs(turned);
}

double ConfigurationSearch::median(std::vector<double> values) {
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  if (values.empty()) return 1;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return std::max(values[values.size() / 2], 1e-300);
}

/// A random neighbour within the working range.
State<double> ConfigurationSearch::neighbour(const State<double>& s, double step) {
  State<double> moved = s;
  const auto symmetric = [this] { return 2 * source_.uniform() - 1; };
  for (const std::size_t i : coordinates_) {
    const double lower = model_.coordinates[i].lower.to_double(),
                 upper = model_.coordinates[i].upper.to_double();
    moved.r[i] = std::clamp(s.r[i] + step * (upper - lower) * symmetric(), lower, upper);
  }
  if (orientation_) {
    Eigen::Vector3d turn(3 * step * symmetric(), 3 * step * symmetric(), 3 * step * symmetric());
    if (model_.group == GroupKind::SE2) turn.head<2>().setZero();
    const Eigen::Matrix3d R = lie::SO3<double>::exp(turn).R();
    Mat3<double> by;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) by(i, j) = R(i, j);
    }
    moved.R = s.R * by;
  }
  return moved;
}

std::optional<State<double>> ConfigurationSearch::lowest(const Quality& quality, double enough) {
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t i = 0; i < states_.size(); ++i) ranked.emplace_back(quality(states_[i]), i);
  std::ranges::sort(ranked);
  const int dimensions = static_cast<int>(coordinates_.size()) + (orientation_ ? 3 : 0);
  for (int d = 0; d < descents; ++d) {
    State<double> best = states_[ranked[static_cast<std::size_t>(d)].second];
    double least = ranked[static_cast<std::size_t>(d)].first;
    double step = 0.1;  // of the range
    for (int i = 0; i < steps_each * dimensions && least > enough && step > 1e-14; ++i) {
      const State<double> tried = neighbour(best, step);
      const double value = quality(tried);
      const bool better = value < least;
      if (better) best = tried, least = value;
      step *= better ? 1.7 : 0.87;  // keeps about one success in five
      step = std::min(step, 0.5);
    }
    if (least <= enough) return best;
  }
  return std::nullopt;
}

std::string ConfigurationSearch::text_of(const State<double>& s) const {
  std::string text;
  const auto rounded = [](double x) { return fmt::format("{:.3g}", std::abs(x) < 5e-4 ? 0.0 : x); };
  for (const std::size_t i : coordinates_)
    text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", model_.coordinates[i].name, rounded(s.r[i]));
  if (!orientation_) return text;
  text += text.empty() ? "R = [" : ", R = [";
  for (int i = 0; i < 3; ++i)
    text += fmt::format("{}[{}, {}, {}]", i == 0 ? "" : ", ", rounded(s.R(i, 0)), rounded(s.R(i, 1)),
                        rounded(s.R(i, 2)));
  return text + "]";
}

}  // namespace anholon
