// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/solids.hpp"

namespace anholon {
namespace {

Exact ratio(long a, long b) { return Exact::ratio(a, b); }

/// The solid with the half axes a, b, c whose square lengths are a factor times (b^2 + c^2, ...).
Solid with_half_axes(const Exact& volume, const Exact& factor, const ExactVector& h) {
  const ExactVector s = {h[0] * h[0], h[1] * h[1], h[2] * h[2]};
  return {volume, {factor * (s[1] + s[2]), factor * (s[0] + s[2]), factor * (s[0] + s[1])}};
}

}  // namespace

Solid ball(const Exact& radius) { return ellipsoid({radius, radius, radius}); }

Solid box(const ExactVector& h) { return with_half_axes(Exact(8) * h[0] * h[1] * h[2], ratio(1, 3), h); }

Solid ellipsoid(const ExactVector& h) {
  return with_half_axes(ratio(4, 3) * Exact::pi() * h[0] * h[1] * h[2], ratio(1, 5), h);
}

Solid cylinder(const Exact& radius, const Exact& half) {
  const Exact square = radius * radius;
  const Exact across = square / Exact(4) + half * half / Exact(3);
  return {Exact(2) * Exact::pi() * square * half, {across, across, square / Exact(2)}};
}

/// The centre of a half ball is 3/8 of its radius from the flat side.
Solid capsule(const Exact& radius, const Exact& half) {
  const Solid middle = cylinder(radius, half), ends = ball(radius);
  const Exact whole = Exact(4) * radius + Exact(6) * half;  // both volumes are this over 3 pi r^2, in parts
  const Exact in_ends = Exact(4) * radius / whole, in_middle = Exact(6) * half / whole;
  const Exact away = half * half + ratio(3, 4) * radius * half;
  const Exact across = in_middle * middle.square_lengths[0] + in_ends * (ends.square_lengths[0] + away);
  const Exact along = in_middle * middle.square_lengths[2] + in_ends * ends.square_lengths[2];
  return {middle.volume + ends.volume, {across, across, along}};
}

BodyOfSolids joined(const std::vector<PlacedSolid>& solids) {
  BodyOfSolids body{0, {0, 0, 0}, {}};
  ExactMatrix about_origin;
  const auto add_point = [](ExactMatrix& I, const Exact& mass, const ExactVector& c) {
    const Exact square = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) I[3 * i + j] += mass * ((i == j ? square : Exact(0)) - c[i] * c[j]);
    }
  };
  for (const PlacedSolid& s : solids) {
    body.mass += s.mass;
    for (std::size_t i = 0; i < 3; ++i) body.centre[i] += s.mass * s.pose.p[i];
    const auto& k = s.solid.square_lengths;
    const ExactMatrix own = {s.mass * k[0], 0, 0, 0, s.mass * k[1], 0, 0, 0, s.mass * k[2]};
    const ExactMatrix& R = s.pose.R;
    const ExactMatrix turned = R == identity_matrix() ? own : product(product(R, own), transposed(R));
    for (std::size_t i = 0; i < 9; ++i) about_origin[i] += turned[i];
    add_point(about_origin, s.mass, s.pose.p);
  }
  for (Exact& x : body.centre) x = settled(x / body.mass);
  add_point(about_origin, -body.mass, body.centre);
  const std::array<std::size_t, 6> entries = {0, 4, 8, 1, 2, 5};
  for (std::size_t i = 0; i < 6; ++i) body.inertia[i] = settled(about_origin[entries[i]]);
  return body;
}

}  // namespace anholon
