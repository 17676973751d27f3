// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/exact_rotation.hpp"

#include <cmath>
#include <numbers>

namespace anholon {

const Exact& snapping_distance() {
  static const Exact distance = Exact::from_decimal("1e-10");
  return distance;
}

const Exact& rounding_distance() {
  static const Exact distance = Exact::from_decimal("1e-34");
  return distance;
}

std::optional<int> eighth_turns(const Exact& angle, const Exact& within) {
  const double turns = angle.to_double() / (std::numbers::pi / 4);
  if (std::abs(turns) > 1e6) return std::nullopt;
  const int k = static_cast<int>(std::lround(turns));
  const Exact distance = abs(angle - Exact::ratio(k, 4) * Exact::pi());
  return distance < within ? std::optional(k) : std::nullopt;
}

std::array<Exact, 2> cosine_and_sine(const Exact& angle, bool snap) {
  if (angle.is_zero()) return {1, 0};
  const std::optional<int> turns = eighth_turns(angle, snap ? snapping_distance() : rounding_distance());
  if (!turns) return {cos(angle), sin(angle)};
  const int k = ((*turns % 8) + 8) % 8;
  const Exact h = sqrt(Exact::ratio(1, 2));
  const std::array<Exact, 8> cosine = {1, h, 0, -h, -1, -h, 0, h};
  return {cosine[static_cast<std::size_t>(k)], cosine[static_cast<std::size_t>((k + 6) % 8)]};
}

Exact settled(const Exact& x) {
  if (x.is_rational()) return x;
  const double twice = 2 * x.to_double();
  if (std::abs(twice) > 1e6) return x;
  const Exact near = Exact::ratio(std::lround(twice), 2);
  return abs(x - near) < rounding_distance() ? near : x;
}

ExactMatrix product(const ExactMatrix& a, const ExactMatrix& b) {
  ExactMatrix c;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j)
      c[3 * i + j] = settled(a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j]);
  }
  return c;
}

ExactVector product(const ExactMatrix& a, const ExactVector& v) {
  ExactVector r;
  for (std::size_t i = 0; i < 3; ++i) r[i] = a[3 * i] * v[0] + a[3 * i + 1] * v[1] + a[3 * i + 2] * v[2];
  return r;
}

ExactMatrix transposed(const ExactMatrix& a) {
  return {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
}

ExactMatrix identity_matrix() { return {1, 0, 0, 0, 1, 0, 0, 0, 1}; }

ExactMatrix turn(std::size_t axis, const Exact& angle, bool snap) {
  const std::size_t i = (axis + 1) % 3;
  const std::size_t j = (axis + 2) % 3;
  const auto [c, s] = cosine_and_sine(angle, snap);
  ExactMatrix R;
  R[4 * axis] = 1;
  R[4 * i] = c;
  R[4 * j] = c;
  R[3 * i + j] = -s;
  R[3 * j + i] = s;
  return R;
}

ExactPose compose(const ExactPose& a, const ExactPose& b) {
  if (a.R == identity_matrix()) return {b.R, {a.p[0] + b.p[0], a.p[1] + b.p[1], a.p[2] + b.p[2]}};
  const ExactVector p = product(a.R, b.p);
  return {b.R == identity_matrix() ? a.R : product(a.R, b.R),
          {settled(a.p[0] + p[0]), settled(a.p[1] + p[1]), settled(a.p[2] + p[2])}};
}

ExactPose inverse(const ExactPose& a) {
  const ExactMatrix R = transposed(a.R);
  const ExactVector p = product(R, a.p);
  return {R, {-settled(p[0]), -settled(p[1]), -settled(p[2])}};
}

ExactVector unit_vector(const ExactVector& a, bool snap) {
  const Exact square = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
  const Exact length = square == Exact(1) ? Exact(1) : settled(sqrt(square));
  ExactVector u = {a[0] / length, a[1] / length, a[2] / length};
  for (std::size_t k = 0; k < 3; ++k) {
    const Exact& first = abs(u[(k + 1) % 3]);
    const Exact& second = abs(u[(k + 2) % 3]);
    const bool exact = first.is_zero() && second.is_zero();
    if (!exact && !(snap && first < snapping_distance() && second < snapping_distance())) continue;
    const Exact along = sign(u[k]);
    u = {0, 0, 0};
    u[k] = along;
    return u;
  }
  return u;
}

}  // namespace anholon
