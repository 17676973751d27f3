// SPDX-License-Identifier: GPL-2.0-or-later
// Mass, first moment and inertia of a rigid body. A description gives as much as the body's motion uses: a
// planar body only zz, a rotor no mass. What is given must be physical at the default parameters.
#include <fmt/format.h>

#include "describe/read_parts.hpp"

namespace anholon {
namespace {

constexpr std::array<std::string_view, 6> entry_names = {"xx", "yy", "zz", "xy", "xz", "yz"};
constexpr std::array<std::array<std::size_t, 2>, 6> entry_axes = {
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};

/// Inertia entries with a mark at those that were given.
struct TensorEntries {
  std::array<Expr, 6> entries = {0, 0, 0, 0, 0, 0};
  std::array<bool, 6> given = {};
};

TensorEntries read_tensor(const Value& value, const std::string& what, Reading& reading) {
  TensorEntries tensor;
  TableReader table(value, what, reading.findings);
  for (std::size_t i = 0; i < 6; ++i) {
    const Value* entry = table.optional(entry_names[i]);
    if (entry == nullptr) continue;
    tensor.entries[i] = reading.number(*entry, fmt::format("{} of {}", entry_names[i], what), units::kg_m2);
    tensor.given[i] = true;
    for (const std::size_t axis : entry_axes[i]) {
      if (table.optional(entry_names[axis]) != nullptr || tensor.entries[i].is_zero()) continue;
      reading.findings.error(entry->where,
                             fmt::format("{} has '{}' but no '{}'", what, entry_names[i], entry_names[axis]),
                             "give the moments of both axes of a product of inertia");
    }
  }
  table.report_unknown_keys();
  return tensor;
}

/// s.s 1 - s s^T, in the order of the entries
template <class S>
std::array<S, 6> spread(const std::array<S, 3>& s) {
  std::array<S, 3> square;
  for (std::size_t i = 0; i < 3; ++i) square[i] = s[i] * s[i];
  const S xx = square[1] + square[2];
  const S yy = square[0] + square[2];
  const S zz = square[0] + square[1];
  const S xy = -(s[0] * s[1]);
  const S xz = -(s[0] * s[2]);
  const S yz = -(s[1] * s[2]);
  return {xx, yy, zz, xy, xz, yz};
}

/// All principal minors of the rows and columns marked in `axes` are at least -tolerance.
bool is_semidefinite(const std::array<Exact, 6>& I, const std::array<bool, 3>& axes, const Exact& scale) {
  static const Exact rounding = Exact::from_decimal("1e-30");
  const Exact least = -(rounding * scale);
  const auto minor2 = [&](std::size_t i, std::size_t j, std::size_t ij) {
    return I[i] * I[j] - I[ij] * I[ij];
  };
  for (std::size_t i = 0; i < 3; ++i) {
    if (axes[i] && I[i] < least) return false;
  }
  for (std::size_t entry = 3; entry < 6; ++entry) {
    const auto [i, j] = entry_axes[entry];
    if (axes[i] && axes[j] && minor2(i, j, entry) < least * scale) return false;
  }
  if (!axes[0] || !axes[1] || !axes[2]) return true;
  const Exact determinant =
      I[0] * minor2(1, 2, 5) - I[3] * (I[3] * I[2] - I[4] * I[5]) + I[4] * (I[3] * I[5] - I[4] * I[1]);
  return determinant >= least * scale * scale;
}

/// The inertia about the mass centre, at the default parameters, belongs to a body that could exist.
void check_physical(const TensorEntries& tensor, const BodyDescription& body, const Location& where,
                    const std::string& what, Reading& reading) {
  const std::array<bool, 3> axes = {tensor.given[0], tensor.given[1], tensor.given[2]};
  const Exact mass = reading.at_defaults(body.mass, where, what);
  std::array<Exact, 3> s;
  for (std::size_t i = 0; i < 3; ++i) s[i] = reading.at_defaults(body.first_moment[i], where, what);
  std::array<Exact, 6> I;
  for (std::size_t i = 0; i < 6; ++i) I[i] = reading.at_defaults(body.inertia[i], where, what);
  Exact scale = 0;
  for (const Exact& entry : I) scale = scale + abs(entry);
  if (!mass.is_zero()) {
    const std::array<Exact, 6> shift = spread(s);
    for (std::size_t i = 0; i < 6; ++i) I[i] = I[i] - shift[i] / mass;
  }
  if (!is_semidefinite(I, axes, scale)) {
    reading.findings.error(where, fmt::format("{} about its mass centre is not positive semidefinite", what),
                           "check the moments, the signs of the products and the mass centre");
    return;
  }
  if (!axes[0] || !axes[1] || !axes[2]) return;
  // second moments of mass, tr(I)/2 1 - I: the triangle inequality of the principal moments
  const Exact half_trace = (I[0] + I[1] + I[2]) / Exact(2);
  const std::array<Exact, 6> second = {
      half_trace - I[0], half_trace - I[1], half_trace - I[2], -I[3], -I[4], -I[5]};
  if (!is_semidefinite(second, axes, scale)) {
    reading.findings.error(
        where,
        fmt::format("{} breaks the triangle inequality: one principal moment about the mass centre "
                    "is larger than the sum of the others",
                    what),
        "no mass distribution has these moments; check them");
  }
}

}  // namespace

void read_inertia(BodyOutline& body, BodyDescription& described, Reading& reading) {
  const Value* value = body.table.optional("inertia", Value::Kind::table);
  if (value == nullptr) return;
  const std::size_t before = reading.findings.size();
  const std::string whose = body.table.what();
  TableReader table(*value, fmt::format("the inertia of {}", whose), reading.findings);
  const Value* mass = table.optional("mass");
  if (mass != nullptr) {
    described.mass = reading.number(*mass, fmt::format("the mass of {}", whose), units::kg);
    const Exact at_defaults =
        reading.at_defaults(described.mass, mass->where, fmt::format("the mass of {}", whose));
    if (at_defaults < Exact(0))
      reading.findings.error(mass->where, fmt::format("the mass of {} is {}", whose, at_defaults.decimal(8)),
                             "a mass must not be negative");
  }
  const Value* com = table.optional("com");
  const Value* first_moment = table.optional("first_moment");
  if (com != nullptr && first_moment != nullptr)
    reading.findings.error(first_moment->where, fmt::format("{} has a com and a first_moment", table.what()),
                           "keep one: the first moment is mass times com");
  std::array<Expr, 3> c = {0, 0, 0};
  if (com != nullptr) {
    c = reading.vector3(*com, fmt::format("the com of {}", whose), units::m);
    for (std::size_t i = 0; i < 3; ++i) described.first_moment[i] = described.mass * c[i];
  } else if (first_moment != nullptr) {
    described.first_moment =
        reading.vector3(*first_moment, fmt::format("the first_moment of {}", whose), units::kg_m);
  }
  const Value* about_com = table.optional("about_com", Value::Kind::table);
  const Value* about_origin = table.optional("about_origin", Value::Kind::table);
  if (about_com != nullptr && about_origin != nullptr)
    reading.findings.error(about_origin->where,
                           fmt::format("{} has about_com and about_origin", table.what()), "keep one");
  const Value* given = about_com != nullptr ? about_com : about_origin;
  TensorEntries tensor;
  if (given != nullptr) {
    tensor = read_tensor(
        *given,
        fmt::format("the inertia {} of {}", about_com != nullptr ? "about_com" : "about_origin", whose),
        reading);
  }
  table.report_unknown_keys();
  described.inertia = tensor.entries;
  if (about_origin == nullptr && !described.mass.is_zero()) {
    // parallel axes: I_origin = I_com + m (c.c 1 - c c^T)
    const std::array<Expr, 6> shift = spread(com != nullptr ? c : described.first_moment);
    for (std::size_t i = 0; i < 6; ++i)
      described.inertia[i] += com != nullptr ? described.mass * shift[i] : shift[i] / described.mass;
  }
  if (reading.findings.size() > before) return;
  const Exact m = reading.at_defaults(described.mass, value->where, fmt::format("the mass of {}", whose));
  for (const Expr& s : described.first_moment) {
    if (m.is_zero() && !reading.at_defaults(s, value->where, table.what()).is_zero()) {
      reading.findings.error(value->where,
                             fmt::format("{} has a first moment but no mass", body.table.what()),
                             "give it a mass");
      return;
    }
  }
  if (given != nullptr)
    check_physical(tensor, described, given->where, fmt::format("the inertia of {}", whose), reading);
}

}  // namespace anholon
