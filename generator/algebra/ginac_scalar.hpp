// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// GiNaC's expression as a scalar: interpret<GiNaC::ex>(tape, roots, inputs) runs a tape over it.

#include <cln/real.h>
#include <ginac/ginac.h>

#include "tape/interpret.hpp"

namespace GiNaC {

/// Found by argument-dependent look-up where a tape applies Op::sign.
inline ex sign(const ex& x) { return csgn(x); }

}  // namespace GiNaC

namespace anholon {

template <>
struct FromExact<GiNaC::ex> {
  GiNaC::ex operator()(const Exact& value) const { return GiNaC::numeric(cln::cl_N(value.value())); }
};

}  // namespace anholon
