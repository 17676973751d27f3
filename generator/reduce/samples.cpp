// SPDX-License-Identifier: GPL-2.0-or-later
#include "reduce/samples.hpp"

#include <fmt/format.h>

#include <cmath>

namespace anholon {
namespace {

Exact rounded(const Exact& x) { return Exact::from_double(x.to_double()); }

/// Rotation of an exact unit quaternion with rational entries, so that R is orthonormal to all digits.
Mat3<Exact> rotation(const Exact& w, const Exact& x, const Exact& y, const Exact& z) {
  const Exact n = Exact(1) / (w * w + x * x + y * y + z * z);
  const Exact two = Exact(2) * n;
  return {{Exact(1) - two * (y * y + z * z), two * (x * y - w * z), two * (x * z + w * y),
           two * (x * y + w * z), Exact(1) - two * (x * x + z * z), two * (y * z - w * x),
           two * (x * z - w * y), two * (y * z + w * x), Exact(1) - two * (x * x + y * y)}};
}

/// Angles at which constraints tend to lose rank.
std::vector<std::pair<std::string, Exact>> special_angles() {
  const WorkingDigits digits(60);
  std::vector<std::pair<std::string, Exact>> angles = {{"0", Exact(0)}};
  for (const int k : {1, 2, 3, 4}) {
    const Exact angle = rounded(Exact::pi() * Exact::ratio(k, 4));
    angles.emplace_back(fmt::format("{}pi/4", k), angle);
    angles.emplace_back(fmt::format("-{}pi/4", k), -angle);
  }
  return angles;
}

}  // namespace

double SampleSource::uniform() {
  state_ += 0x9E3779B97F4A7C15ULL;  // splitmix64
  std::uint64_t x = state_;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  x ^= x >> 31;
  return static_cast<double>(x >> 11) * 0x1p-53;
}

Exact SampleSource::uniform(const Exact& lower, const Exact& upper) {
  return rounded(lower + (upper - lower) * Exact::from_double(uniform()));
}

State<Exact> random_state(const Model& model, SampleSource& source) {
  State<Exact> s;
  const auto symmetric = [&](int bound) { return source.uniform(Exact(-bound), Exact(bound)); };
  const GroupKind group = model.group;
  if (group == GroupKind::SE3 || group == GroupKind::SO3) {
    Exact w = symmetric(1);
    const Exact x = symmetric(1), y = symmetric(1), z = symmetric(1);
    if (w.is_zero()) w = 1;
    s.R = rotation(w, x, y, z);
    for (Exact& e : s.R.m) e = rounded(e);  // what double code is given; orthonormal to 1e-16
  }
  if (group == GroupKind::SE2) {
    const Exact theta = symmetric(3);
    const WorkingDigits digits(60);
    s.R = AxisRotation<Exact>{2, cos(theta), sin(theta)}.matrix();
    for (Exact& e : s.R.m) e = rounded(e);
  }
  const auto components = free_components(group);
  for (const int c : components) {
    if (c < 3) s.p[c] = symmetric(1);
    s.eta[c] = symmetric(1);
  }
  for (const Coordinate& c : model.coordinates) {
    s.r.push_back(source.uniform(c.lower, c.upper));
    s.r_dot.push_back(symmetric(1));
  }
  return s;
}

std::vector<SampleState> sample_states(const Model& model, int random_count) {
  SampleSource source;
  std::vector<SampleState> samples;
  for (int i = 0; i < random_count; ++i)
    samples.push_back({fmt::format("random {}", i + 1), false, random_state(model, source)});

  std::vector<std::size_t> angles;
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    if (model.coordinates[i].is_angle) angles.push_back(i);
  }
  const auto add = [&](const std::string& label, const auto& value_of) {
    SampleState sample{label, true, random_state(model, source)};
    for (std::size_t k = 0; k < angles.size(); ++k) {
      const Coordinate& c = model.coordinates[angles[k]];
      const Exact value = value_of(k);
      if (value < c.lower || value > c.upper) return;
      sample.state.r[angles[k]] = value;
    }
    samples.push_back(std::move(sample));
  };
  const auto special = special_angles();
  for (const auto& [text, angle] : special) {
    add(fmt::format("all angles {}", text), [&](std::size_t) { return angle; });
    if (angles.size() > 1)
      add(fmt::format("angles alternately +-{}", text),
          [&](std::size_t k) { return k % 2 == 0 ? angle : -angle; });
  }
  for (std::size_t i = 0; i < angles.size(); ++i) {  // one angle special, the others random
    for (const auto& [text, angle] : special) {
      SampleState sample{fmt::format("{} = {}", model.coordinates[angles[i]].name, text), true,
                         random_state(model, source)};
      const Coordinate& c = model.coordinates[angles[i]];
      if (angle < c.lower || angle > c.upper) continue;
      sample.state.r[angles[i]] = angle;
      samples.push_back(std::move(sample));
    }
  }
  if (angles.size() > 1) {
    const Exact common = source.uniform(Exact(-1), Exact(1));
    add("all angles equal", [&](std::size_t) { return common; });
    add("angles equal and opposite", [&](std::size_t k) { return k % 2 == 0 ? common : -common; });
  }
  return samples;
}

}  // namespace anholon
