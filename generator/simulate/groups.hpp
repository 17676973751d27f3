// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Lie groups over a scalar, chosen at run time by the group of a model.

#include <cmath>
#include <type_traits>

#include "anholon/lie/group_kind.hpp"
#include "anholon/lie/se2.hpp"
#include "anholon/lie/se3.hpp"
#include "anholon/lie/so3.hpp"
#include "anholon/lie/translation.hpp"
#include "anholon/lie/trivial.hpp"
#include "describe/scene.hpp"
#include "tape/interpret.hpp"

namespace anholon {

/// Calls f with a group type over S: R1 and R2 as the translations of space that they are part of.
template <class S, class F>
auto with_group(GroupKind group, F&& f) {
  switch (group) {
    case GroupKind::SE3:
      return f(std::type_identity<lie::SE3<S>>{});
    case GroupKind::SE2:
      return f(std::type_identity<lie::SE2<S>>{});
    case GroupKind::SO3:
      return f(std::type_identity<lie::SO3<S>>{});
    case GroupKind::R1:
    case GroupKind::R2:
    case GroupKind::R3:
      return f(std::type_identity<lie::Translation<S, 3>>{});
    case GroupKind::fixed:
      break;
  }
  return f(std::type_identity<lie::Trivial<S>>{});
}

/// The pose at t = 0.
template <class G>
G pose_of(const InitialState& initial) {
  using Real = typename G::Scalar;
  Eigen::Matrix<Real, 3, 3> R;
  Eigen::Matrix<Real, 3, 1> p;
  const FromExact<Real> real;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R(i, j) = real(initial.R[static_cast<std::size_t>(3 * i + j)]);
    p(i) = real(initial.p[static_cast<std::size_t>(i)]);
  }
  const Eigen::Quaternion<Real> q(R);
  const Eigen::Matrix<Real, 4, 1> wxyz(q.w(), q.x(), q.y(), q.z());
  if constexpr (std::is_same_v<G, lie::SE3<Real>>) {
    return G(wxyz, p);
  } else if constexpr (std::is_same_v<G, lie::SO3<Real>>) {
    return G(wxyz);
  } else if constexpr (std::is_same_v<G, lie::SE2<Real>>) {
    return G(p(0), p(1), std::atan2(R(1, 0), R(0, 0)));
  } else if constexpr (G::dim == 0) {
    return G::identity();
  } else {
    return G(typename G::Tangent(p.template head<G::dim>()));
  }
}

}  // namespace anholon
