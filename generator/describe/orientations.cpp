// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/orientations.hpp"

#include <fmt/format.h>

namespace anholon {
namespace {

/// "pi/2", "-3 pi/4" for k quarters of pi.
std::string quarters_of_pi(int k) {
  if (k == 0) return "0";
  const int divisor = k % 4 == 0 ? 4 : k % 2 == 0 ? 2 : 1;
  const int numerator = k / divisor;
  const std::string factor = numerator == 1 ? "" : numerator == -1 ? "-" : fmt::format("{} ", numerator);
  return fmt::format("{}pi{}", factor, divisor == 4 ? "" : fmt::format("/{}", 4 / divisor));
}

Exact dot(const ExactVector& a, const ExactVector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool is_rotation(const ExactMatrix& R) {
  const ExactMatrix square = product(R, transposed(R));
  for (std::size_t i = 0; i < 9; ++i) {
    if (abs(square[i] - Exact(i % 4 == 0 ? 1 : 0)) > rounding_distance()) return false;
  }
  return true;
}

}  // namespace

ExactMatrix Orientations::angle(std::size_t axis, const Exact& value, std::string_view name,
                                const std::string& of) {
  if (snap_ && !value.is_zero()) {
    const auto turns = eighth_turns(value, snapping_distance());
    if (turns && abs(value - Exact::ratio(*turns, 4) * Exact::pi()) > rounding_distance())
      notes_.push_back(fmt::format("snapped: {} {} of {} taken as {}", name, value.decimal(20), of,
                                   quarters_of_pi(*turns)));
  }
  return turn(axis, value, snap_);
}

ExactMatrix Orientations::rpy(const ExactVector& angles, const std::string& of) {
  const ExactMatrix roll = angle(0, angles[0], "roll", of);
  const ExactMatrix pitch = angle(1, angles[1], "pitch", of);
  const ExactMatrix yaw = angle(2, angles[2], "yaw", of);
  return product(product(yaw, pitch), roll);
}

ExactMatrix Orientations::euler(const std::array<std::size_t, 3>& axes, const ExactVector& angles,
                                const std::string& of) {
  constexpr std::array<const char*, 3> names = {"the first angle", "the second angle", "the third angle"};
  ExactMatrix R = identity_matrix();
  for (std::size_t i = 0; i < 3; ++i) R = product(R, angle(axes[i], angles[i], names[i], of));
  return R;
}

ExactMatrix Orientations::quaternion(const std::array<Exact, 4>& wxyz, const std::string& of) {
  const auto& [w, x, y, z] = wxyz;
  const Exact two(2);
  const Exact square = w * w + x * x + y * y + z * z;
  ExactMatrix R = {
      w * w + x * x - y * y - z * z, two * (x * y - w * z),         two * (x * z + w * y),
      two * (x * y + w * z),         w * w - x * x + y * y - z * z, two * (y * z - w * x),
      two * (x * z - w * y),         two * (y * z + w * x),         w * w - x * x - y * y + z * z};
  for (Exact& entry : R) entry /= square;
  return snapped(R, of);
}

ExactMatrix Orientations::axis_angle(const ExactVector& axis, const Exact& value, const std::string& of) {
  const ExactVector u = unit_vector(axis, snap_);
  for (std::size_t k = 0; k < 3; ++k) {
    if (abs(u[k]) == Exact(1)) return angle(k, u[k] * value, "the angle", of);
  }
  const auto [c, s] = cosine_and_sine(value, snap_);
  const Exact d = Exact(1) - c;
  return snapped({c + d * u[0] * u[0], d * u[0] * u[1] - s * u[2], d * u[0] * u[2] + s * u[1],
                  d * u[0] * u[1] + s * u[2], c + d * u[1] * u[1], d * u[1] * u[2] - s * u[0],
                  d * u[0] * u[2] - s * u[1], d * u[1] * u[2] + s * u[0], c + d * u[2] * u[2]},
                 of);
}

ExactMatrix Orientations::x_and_y(const ExactVector& x, const ExactVector& y, const std::string& of) {
  const ExactVector a = unit_vector(x, snap_);
  const Exact along = dot(a, y);
  const ExactVector b = unit_vector({y[0] - along * a[0], y[1] - along * a[1], y[2] - along * a[2]}, snap_);
  return snapped({a[0], b[0], a[1] * b[2] - a[2] * b[1],  //
                  a[1], b[1], a[2] * b[0] - a[0] * b[2],  //
                  a[2], b[2], a[0] * b[1] - a[1] * b[0]},
                 of);
}

ExactMatrix Orientations::z_axis(const ExactVector& z, const std::string& of) {
  const ExactVector u = unit_vector(z, snap_);
  const ExactVector k = {-u[1], u[0], 0};  // z x u: its length is the sine
  const Exact& c = u[2];
  if (dot(k, k).is_zero()) return c > Exact(0) ? identity_matrix() : ExactMatrix{1, 0, 0, 0, -1, 0, 0, 0, -1};
  const Exact f = Exact(1) / (Exact(1) + c);
  return snapped({c + f * k[0] * k[0], f * k[0] * k[1], k[1],   //
                  f * k[0] * k[1], c + f * k[1] * k[1], -k[0],  //
                  -k[1], k[0], c},
                 of);
}

/// The rotation whose entries are 0, 1/2, sqrt(1/2) and 1, up to signs, within 1e-10 of the given ones.
ExactMatrix Orientations::snapped(const ExactMatrix& R, const std::string& of) {
  ExactMatrix near;
  bool moved = false;
  const std::array<Exact, 4> grid = {0, Exact::ratio(1, 2), sqrt(Exact::ratio(1, 2)), 1};
  for (std::size_t i = 0; i < 9; ++i) {
    const Exact* found = nullptr;
    const Exact size = abs(R[i]);
    for (const Exact& g : grid) {
      if (abs(size - g) < (snap_ ? snapping_distance() : rounding_distance())) found = &g;
    }
    if (found == nullptr) return R;
    near[i] = R[i] < Exact(0) ? -*found : *found;
    moved = moved || abs(near[i] - R[i]) > rounding_distance();
  }
  if (!is_rotation(near)) return R;
  if (moved) notes_.push_back(fmt::format("snapped: the orientation of {} taken as exact", of));
  return near;
}

}  // namespace anholon
