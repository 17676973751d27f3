// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A compliant body as a table: the inertia shape invariants, modal stiffness and damping, and the mode shapes
// at stations that a finite-element reduction exports, in the layout of docs/model-file.md. All numbers are
// exact decimals in SI units.

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "describe/document.hpp"
#include "describe/findings.hpp"
#include "number/exact.hpp"

namespace anholon {

struct ModalTable {
  using Vector = std::array<Exact, 3>;
  using Tensor = std::array<Exact, 9>;  // row-major
  template <class T>
  using PerPair = std::vector<std::vector<T>>;

  struct Station {
    std::string name;
    Vector at{};
    std::vector<Vector> phi, turn;
    PerPair<Vector> psi;  // empty where it is not given
  };

  Exact mass;
  Vector first_moment{};
  Tensor inertia{};  // about the origin
  std::vector<Vector> S;
  std::vector<Tensor> X_phi;
  PerPair<Tensor> phi_phi;
  PerPair<Vector> psi;  // empty where it is not given; X_psi too
  PerPair<Tensor> X_psi;
  PerPair<Exact> stiffness, damping;
  std::vector<Station> stations;

  [[nodiscard]] std::size_t modes() const { return S.size(); }
};

/// Whether a symmetric matrix has no negative pivot beyond rounding to 1e-6, by elimination without a square
/// root.
bool is_semidefinite(ModalTable::PerPair<Exact> a);

/// Reads and checks a table: shapes, symmetry to 1e-6 of the largest entry (the mean of both halves is
/// taken), no negative stiffness or damping, and a mass matrix of body and modes that is positive
/// semidefinite. Errors go to `findings`; the table is usable where there are none.
ModalTable read_modal_table(const std::filesystem::path& file, const Location& named_at, Findings& findings);

}  // namespace anholon
