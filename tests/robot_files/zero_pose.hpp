// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What a model says of its links and joints where all coordinates are zero, in the frame of the reference
// body, to be held against another reader of the same file.

#include <map>
#include <string>

#include "anholon/spatial.hpp"
#include "describe/model.hpp"

namespace anholon::testing {

struct SeenLink {
  Mat3<double> R;  // of the link in the reference body
  Vec3<double> p;
  Vec3<double> axis;  // of its joint, in the reference body; zero where it has none
  double mass = 0;
  Vec3<double> first_moment;  // about its origin, in its axes
  Mat3<double> inertia;
};

inline std::map<std::string, SeenLink> seen_links(const Model& model) {
  const auto value = [](const Expr& e) { return e.constant_value().value().to_double(); };
  std::vector<SeenLink> all;
  std::map<std::string, SeenLink> by_name;
  for (const BodyDescription& b : model.bodies) {
    SeenLink s;
    for (std::size_t i = 0; i < 9; ++i) s.R.m[i] = value(b.R[i]);
    for (int i = 0; i < 3; ++i) {
      const auto k = static_cast<std::size_t>(i);
      s.p[i] = value(b.p[k]);
      s.axis[i] = b.joint.kind == JointKind::fixed ? 0 : value(b.joint.axis[k]);
      s.first_moment[i] = value(b.first_moment[k]);
      s.inertia(i, i) = value(b.inertia[k]);
      const int x = i == 2 ? 1 : 0, y = i == 0 ? 1 : 2;  // xy xz yz
      s.inertia(x, y) = s.inertia(y, x) = value(b.inertia[3 + k]);
    }
    s.mass = value(b.mass);
    if (b.parent >= 0) {
      const SeenLink& parent = all[static_cast<std::size_t>(b.parent)];
      s.p = parent.p + parent.R * s.p;
      s.R = parent.R * s.R;
    }
    s.axis = s.R * s.axis;
    all.push_back(s);
    by_name[b.name] = s;
  }
  return by_name;
}

/// Largest difference of entries.
inline double distance(const Vec3<double>& a, const Vec3<double>& b) {
  double most = 0;
  for (int i = 0; i < 3; ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}
inline double distance(const Mat3<double>& a, const Mat3<double>& b) {
  double most = 0;
  for (std::size_t i = 0; i < 9; ++i) most = std::max(most, std::abs(a.m[i] - b.m[i]));
  return most;
}

/// First moment and inertia about the origin of a body given by its centre of mass and central inertia.
inline Vec3<double> first_moment(double mass, const Vec3<double>& centre) { return mass * centre; }
inline Mat3<double> about_origin(const Mat3<double>& central, double mass, const Vec3<double>& centre) {
  Mat3<double> I = central;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      I(i, j) += mass * ((i == j ? dot(centre, centre) : 0.0) - centre[i] * centre[j]);
  }
  return I;
}

}  // namespace anholon::testing
