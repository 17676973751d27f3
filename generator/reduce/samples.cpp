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

/// k pi/4 as one writes it: "0", "-pi/4", "pi/2", "3pi/4".
std::string quarters_of_pi(int k) {
  if (k == 0) return "0";
  const int numerator = std::abs(k) % 4 == 0   ? std::abs(k) / 4
                        : std::abs(k) % 2 == 0 ? std::abs(k) / 2
                                               : std::abs(k);
  const char* denominator = k % 4 == 0 ? "" : k % 2 == 0 ? "/2" : "/4";
  return fmt::format("{}{}pi{}", k < 0 ? "-" : "", numerator == 1 ? "" : std::to_string(numerator),
                     denominator);
}

/// A value that a sample was given, with the text that reports use for it.
struct NamedValue {
  std::string text;
  Exact value;
  [[nodiscard]] NamedValue negative() const {
    if (value.is_zero()) return *this;
    return {text.starts_with('-') ? text.substr(1) : "-" + text, -value};
  }
};

bool reads_time(const Model& model) {
  const Tape& tape = *model.tape;
  for (NodeId id = 0; id < tape.size(); ++id) {
    const Node& n = tape.node(id);
    const int arity = info(n.op).arity;
    if ((arity >= 1 && n.a == model.symbols.t) || (arity == 2 && n.b == model.symbols.t)) return true;
  }
  return false;
}

/// Angles at which constraints tend to lose rank.
std::vector<NamedValue> special_angles() {
  const WorkingDigits digits(60);
  std::vector<NamedValue> angles = {{"0", Exact(0)}};
  for (const int k : {1, 2, 3, 4}) {
    angles.push_back({quarters_of_pi(k), rounded(Exact::pi() * Exact::ratio(k, 4))});
    angles.push_back(angles.back().negative());
  }
  return angles;
}

/// A random sample whose coordinates are reported by their values.
SampleState random_sample(const Model& model, SampleSource& source) {
  SampleState sample;
  sample.state = random_state(model, source);
  for (std::size_t i = 0; i < model.coordinates.size(); ++i)
    sample.places.push_back(
        {model.coordinates[i].name, fmt::format("{:.3g}", sample.state.r[i].to_double()), false});
  return sample;
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
  if (reads_time(model)) s.t = source.uniform(Exact(0), Exact(10));
  return s;
}

std::vector<SampleState> sample_states(const Model& model, int random_count) {
  SampleSource source;
  std::vector<SampleState> samples;
  for (int i = 0; i < random_count; ++i) samples.push_back(random_sample(model, source));

  std::vector<std::size_t> angles;
  for (std::size_t i = 0; i < model.coordinates.size(); ++i) {
    if (model.coordinates[i].is_angle) angles.push_back(i);
  }
  if (angles.empty()) return samples;
  /// False where the value is out of the working range.
  const auto place = [&](SampleState& sample, std::size_t coordinate, const NamedValue& to) {
    const Coordinate& c = model.coordinates[coordinate];
    if (to.value < c.lower || to.value > c.upper) return false;
    sample.state.r[coordinate] = to.value;
    sample.places[coordinate] = {c.name, to.text, true};
    return true;
  };
  const auto add_all = [&](const NamedValue& even, const NamedValue& odd) {
    SampleState sample = random_sample(model, source);
    for (std::size_t k = 0; k < angles.size(); ++k) {
      if (!place(sample, angles[k], k % 2 == 0 ? even : odd)) return;
    }
    samples.push_back(std::move(sample));
  };
  const std::vector<NamedValue> special = special_angles();
  for (const NamedValue& angle : special) {
    add_all(angle, angle);
    if (angles.size() > 1) add_all(angle, angle.negative());
  }
  for (const std::size_t coordinate : angles) {  // one angle special, the others random
    for (const NamedValue& angle : special) {
      SampleState sample = random_sample(model, source);
      if (place(sample, coordinate, angle)) samples.push_back(std::move(sample));
    }
  }
  if (angles.size() > 1) {
    const Exact value = source.uniform(Exact(-1), Exact(1));
    const NamedValue common{fmt::format("{:.3g}", value.to_double()), value};
    add_all(common, common);
    add_all(common, common.negative());
  }
  return samples;
}

}  // namespace anholon
