// SPDX-License-Identifier: GPL-2.0-or-later
// A compliant body that a table of invariants describes.
#include <fmt/format.h>

#include <algorithm>

#include "describe/deformation.hpp"
#include "describe/names.hpp"
#include "describe/read_parts.hpp"

namespace anholon {

void read_modal_body(BodyOutline& body, BodyDescription& described, Reading& reading) {
  if (!body.modal) return;
  ModalOutline& modal = *body.modal;
  Model& model = reading.model;
  Tape& tape = *model.tape;
  if (const auto deformation = modal.table.optional_choice("deformation", deformation_names()))
    described.deformation = static_cast<Deformation>(*deformation);
  const Value* range = modal.table.optional("range");
  if (range != nullptr) {
    const auto bounds = reading.range(*range, fmt::format("the range of {}", modal.table.what()), units::m);
    for (std::size_t j = 0; bounds && j < modal.data.modes(); ++j) {
      Coordinate& c = model.coordinates[static_cast<std::size_t>(modal.first_coordinate) + j];
      c.lower = (*bounds)[0], c.upper = (*bounds)[1];
    }
  }
  modal.table.report_unknown_keys();
  const ModalTable& data = modal.data;
  const auto constant = [&](const Exact& value) { return Expr(tape, tape.constant(value)); };
  const auto vector = [&](const ModalTable::Vector& v) {
    return std::array<Expr, 3>{constant(v[0]), constant(v[1]), constant(v[2])};
  };
  const auto tensor = [&](const ModalTable::Tensor& t) {
    std::array<Expr, 9> result;
    for (std::size_t i = 0; i < 9; ++i) result[i] = constant(t[i]);
    return result;
  };
  const std::size_t n = data.modes();
  described.mass += constant(data.mass);
  for (std::size_t i = 0; i < 3; ++i) described.first_moment[i] += constant(data.first_moment[i]);
  constexpr std::array<std::size_t, 6> entries = {0, 4, 8, 1, 2, 5};
  for (std::size_t i = 0; i < 6 && n > 0; ++i) described.inertia[i] += constant(data.inertia[entries[i]]);
  for (std::size_t j = 0; j < n; ++j) {
    ModeDescription mode;
    const std::size_t at = static_cast<std::size_t>(modal.first_coordinate) + j;
    mode.coordinate = static_cast<int>(at);
    mode.S = vector(data.S[j]);
    mode.X_phi = tensor(data.X_phi[j]);
    for (std::size_t l = 0; l < n; ++l) {
      mode.phi_phi.push_back(tensor(data.phi_phi[j][l]));
      if (data.psi.empty()) continue;
      mode.psi.push_back(vector(data.psi[j][l]));
      mode.X_psi.push_back(tensor(data.X_psi[j][l]));
    }
    described.modes.push_back(std::move(mode));
    for (std::size_t l = 0; l <= j; ++l) {
      const std::size_t other = static_cast<std::size_t>(modal.first_coordinate) + l;
      const Exact half = l == j ? Exact::ratio(1, 2) : Exact(1);
      const Expr r(tape, model.symbols.r[at]), r_l(tape, model.symbols.r[other]);
      const Expr rate(tape, model.symbols.r_dot[at]), rate_l(tape, model.symbols.r_dot[other]);
      model.potential += constant(half * data.stiffness[j][l]) * (r * r_l);
      if (!data.damping.empty()) model.dissipation += constant(half * data.damping[j][l]) * (rate * rate_l);
    }
  }
  if (n == 0) return;  // the table has errors of its own
  body.station_on = [data, first = modal.first_coordinate](const Value* station,
                                                           const BodyDescription& hanging, Reading& at) {
    StationDescription result;
    std::vector<std::string> names;
    for (const auto& s : data.stations) names.push_back(s.name);
    const std::string name = station == nullptr ? "tip" : station->text;
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) {
      at.findings.error(station == nullptr ? hanging.where : station->where,
                        fmt::format("body '{}' hangs at station '{}', which the table of modes has not",
                                    hanging.name, name),
                        did_you_mean(name, names,
                                     names.empty() ? "add it to the table"
                                                   : fmt::format("stations are {}", listed(names))));
      return result;
    }
    const ModalTable::Station& s = data.stations[static_cast<std::size_t>(found - names.begin())];
    Tape& on = *at.model.tape;
    const auto number = [&](const ModalTable::Vector& v) {
      std::array<Expr, 3> result_vector;
      for (std::size_t i = 0; i < 3; ++i) result_vector[i] = Expr(on, on.constant(v[i]));
      return result_vector;
    };
    result.at = number(s.at);
    for (std::size_t j = 0; j < s.phi.size(); ++j) {
      StationDescription::Mode mode;
      mode.coordinate = first + static_cast<int>(j);
      mode.phi = number(s.phi[j]);
      mode.turn = number(s.turn[j]);
      for (const auto& psi : s.psi.empty() ? std::vector<ModalTable::Vector>{} : s.psi[j])
        mode.psi.push_back(number(psi));
      result.modes.push_back(std::move(mode));
    }
    return result;
  };
}

}  // namespace anholon
