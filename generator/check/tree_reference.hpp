// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The functions of a tree by the numeric recursion on the mechanism as it is described: every link a body, no
// frames moved, no figures regrouped, the mass matrix by unit sweeps. Shares nothing with derive_tree but the
// recursion's equations.

#include <string>
#include <vector>

#include "anholon/mechanism.hpp"
#include "check/evaluate_program.hpp"

namespace anholon {

/// Where a function of a tree is evaluated.
template <class S>
struct TreePoint {
  State<S> state;
  Spatial<S> eta_dot;          // zero where the group has no such component
  std::vector<S> r_ddot, tau;  // (s)
};

/// The point as the input blocks of a tree's program.
template <class S>
NamedValues<S> tree_inputs(const Mechanism<S>& mechanism, const TreePoint<S>& point);

/// Output blocks of one of tree_function_names(), under the names that derive_tree gives them.
template <class S>
NamedValues<S> tree_reference(const Mechanism<S>& mechanism, const std::string& function,
                              const TreePoint<S>& point);

extern template NamedValues<double> tree_inputs(const Mechanism<double>&, const TreePoint<double>&);
extern template NamedValues<Exact> tree_inputs(const Mechanism<Exact>&, const TreePoint<Exact>&);
extern template NamedValues<double> tree_reference(const Mechanism<double>&, const std::string&,
                                                   const TreePoint<double>&);
extern template NamedValues<Exact> tree_reference(const Mechanism<Exact>&, const std::string&,
                                                  const TreePoint<Exact>&);

}  // namespace anholon
