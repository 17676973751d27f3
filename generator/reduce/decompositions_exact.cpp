// SPDX-License-Identifier: GPL-2.0-or-later
#include "reduce/decompositions.hpp"

namespace anholon {

template class ConstraintFactors<Exact>;
template ConstrainedSolution<Exact> solve_constrained(const DynamicMatrix<Exact>&,
                                                      const DynamicVector<Exact>&,
                                                      const DynamicMatrix<Exact>&,
                                                      const DynamicVector<Exact>&, const Exact&);

}  // namespace anholon
