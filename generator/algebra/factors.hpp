// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Greatest common divisors and factors over the rationals. GiNaC computes them; the answers come back as
// canonical polynomials, so its choice of sign, of scale and of order, which differ from run to run, are
// gone.

#include <utility>
#include <vector>

#include "algebra/polynomial.hpp"

namespace anholon {

/// Primitive greatest common divisor with positive leading coefficient; gcd(0, q) = primitive(q). Operands
/// beyond the bound of terms that GiNaC is trusted with give their common monomial.
Polynomial gcd(const Polynomial& p, const Polynomial& q);

/// p = content * product of factor^exponent, factors primitive and sorted; the content is left out. Beyond
/// the bound monomials and linear variables alone are split off.
std::vector<std::pair<Polynomial, unsigned>> factors(const Polynomial& p);

}  // namespace anholon
