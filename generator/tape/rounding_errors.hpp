// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What rounding leaves of an operation: exact value minus rounded one, by error-free transformations.
// Generated code computes the same (templates/rounding_errors.inl). Scalars that do not round, numbers of
// GiNaC and CLN among them, have no error.

#include <cmath>
#include <type_traits>

namespace anholon {

/// a + b = fl(a + b) + this (Knuth 1969, TwoSum).
template <class S>
S sum_error([[maybe_unused]] const S& a, [[maybe_unused]] const S& b) {
  if constexpr (std::is_floating_point_v<S>) {
    const S sum = a + b, part = sum - a;
    return (a - (sum - part)) + (b - part);
  } else {
    return S(0);
  }
}

/// a b = fl(a b) + this.
template <class S>
S product_error([[maybe_unused]] const S& a, [[maybe_unused]] const S& b) {
  if constexpr (std::is_floating_point_v<S>) {
    return std::fma(a, b, -(a * b));
  } else {
    return S(0);
  }
}

/// a / b = fl(a / b) + this, up to the rounding of this.
template <class S>
S quotient_error([[maybe_unused]] const S& a, [[maybe_unused]] const S& b) {
  if constexpr (std::is_floating_point_v<S>) {
    return std::fma(-(a / b), b, a) / b;  // the remainder is exact
  } else {
    return S(0);
  }
}

}  // namespace anholon
