// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Exact as a scalar of Eigen's factorisations.

#include <Eigen/Core>

#include "number/exact.hpp"

namespace Eigen {

template <>
struct NumTraits<anholon::Exact> : GenericNumTraits<anholon::Exact> {
  using Real = anholon::Exact;
  using NonInteger = anholon::Exact;
  using Nested = anholon::Exact;
  using Literal = anholon::Exact;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 10,
    AddCost = 100,
    MulCost = 500
  };
  static Real epsilon() {
    return anholon::Exact(1) /
           anholon::Exact::from_decimal("1e" + std::to_string(anholon::WorkingDigits::current()));
  }
  static Real dummy_precision() { return epsilon(); }
  static Real highest() { return anholon::Exact::from_decimal("1e4000"); }
  static Real lowest() { return -highest(); }
  static int digits10() { return static_cast<int>(anholon::WorkingDigits::current()); }
};

}  // namespace Eigen
