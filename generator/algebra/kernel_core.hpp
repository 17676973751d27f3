// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Kernel of a small constraint matrix without denominators and without common factors.

#include <optional>
#include <vector>

#include "tape/tape.hpp"

namespace anholon {

struct KernelCoreLimits {
  std::size_t rows = 4;  // of a block that couples its pivots, after the elimination of what is triangular
  std::size_t entry_terms = 40;  // an entry's subexpression beyond this becomes an opaque symbol
  std::size_t terms = 400;       // of any polynomial on the way; beyond it there is no answer
};

/// Velocities (columns of A) = J r_a_dot + H nu: Boyer & Belkhiri 2013, eq. (11), columns of H in ker A, A J
/// = -B.
struct KernelCore {
  std::vector<std::vector<NodeId>> H;  // columns of A x free columns
  std::vector<std::vector<NodeId>> J;  // columns of A x columns of B
};

/// With the pivots P all columns that are not free, up to the scale of each column of H,
///
///   H_P = -adj(A_P) A_F,   H_F = det(A_P) 1,   J_P = -adj(A_P) B / det(A_P),   J_F = 0.
///
/// Each column of H is divided by its content, the common factor of its entries as polynomials in the inputs
/// and in the cosines and sines of angles, c^2 + s^2 = 1; so it stays regular where a division by a pivot is
/// not. The free entry of each column has a positive leading coefficient. The entries of J are cancelled
/// likewise, with one division for each denominator. Rows with a constant pivot and columns with one entry
/// are eliminated first.
///
/// @param A  rows x columns, of full row rank for almost all values of the inputs
/// @param B  rows x any number of columns, perhaps none
/// @param free_columns  columns - rows columns of A, each once, in the order of H's columns
/// @return nothing beyond the limits, or where the other columns of A are dependent
std::optional<KernelCore> kernel_core(Tape& tape, const std::vector<std::vector<NodeId>>& A,
                                      const std::vector<std::vector<NodeId>>& B,
                                      const std::vector<int>& free_columns,
                                      const KernelCoreLimits& limits = {});

}  // namespace anholon
