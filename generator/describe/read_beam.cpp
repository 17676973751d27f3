// SPDX-License-Identifier: GPL-2.0-or-later
// A uniform Euler-Bernoulli beam along the body's x axis, clamped at its origin. Mode j deflects along y or
// z: p = X + sum_j phi_j(X) r_ej, exactly linear in r_e; the kinetic energy keeps every term of this field.
#include <fmt/format.h>

#include "describe/beam.hpp"
#include "describe/read_parts.hpp"

namespace anholon {
namespace {

Expr read_size(BeamOutline& beam, std::string_view key, Dimension unit, std::string_view mend,
               Reading& reading) {
  const Value* value = beam.table.required(key, mend);
  if (value == nullptr) return 1;
  const std::string what = fmt::format("the {} of {}", key, beam.table.what());
  const std::size_t before = reading.findings.size();
  const Expr size = reading.number(*value, what, unit);
  const Exact at_defaults = reading.at_defaults(size, value->where, what);
  if (reading.findings.size() == before && at_defaults <= Exact(0))
    reading.findings.error(value->where, fmt::format("{} is {}", what, at_defaults.decimal(8)),
                           "it must be positive");
  return reading.findings.size() == before ? size : Expr(1);
}

/// Damping coefficient per unit of modal stiffness (material) or as it is (modal); both are optional.
struct Damping {
  std::optional<Expr> modal, material;
};

Damping read_damping(BeamOutline& beam, Reading& reading) {
  Damping damping;
  const Value* modal = beam.table.optional("modal_damping");
  const Value* material = beam.table.optional("material_damping");
  if (modal != nullptr && material != nullptr) {
    reading.findings.error(material->where,
                           fmt::format("{} has modal_damping and material_damping", beam.table.what()),
                           "keep one");
    return damping;
  }
  const Value* value = modal != nullptr ? modal : material;
  if (value == nullptr) return damping;
  const std::string what =
      fmt::format("the {} of {}", modal != nullptr ? "modal_damping" : "material_damping", beam.table.what());
  const Dimension unit = modal != nullptr ? units::newton / units::m_per_s : units::s;
  const Expr c = reading.number(*value, what, unit);
  if (const Exact size = reading.at_defaults(c, value->where, what); size < Exact(0))
    reading.findings.error(value->where, fmt::format("{} is {}", what, size.decimal(8)),
                           "it must not be negative");
  (modal != nullptr ? damping.modal : damping.material) = c;
  return damping;
}

void read_modal_range(BeamOutline& beam, const Expr& length, Reading& reading) {
  const Value* value = beam.table.optional("range");
  const std::string what = fmt::format("the range of {}", beam.table.what());
  std::array<Exact, 2> bounds;
  if (value != nullptr) {
    const auto read = reading.range(*value, what, units::m);
    if (!read) return;
    bounds = *read;
  } else {
    bounds[1] = reading.at_defaults(length, beam.table.table().where, what) / Exact(5);
    bounds[0] = -bounds[1];
    reading.model.notes.push_back(fmt::format("{} is taken as a fifth of its length, [{}, {}] m", what,
                                              bounds[0].decimal(8), bounds[1].decimal(8)));
  }
  const std::size_t count = static_cast<std::size_t>(beam.modes) * beam.planes.size();
  for (std::size_t i = 0; i < count; ++i) {
    Coordinate& coordinate = reading.model.coordinates[static_cast<std::size_t>(beam.first_coordinate) + i];
    coordinate.lower = bounds[0];
    coordinate.upper = bounds[1];
  }
}

}  // namespace

void read_beam(BodyOutline& body, BodyDescription& described, Reading& reading) {
  if (!body.beam) return;
  BeamOutline& beam = *body.beam;
  Model& model = reading.model;
  Tape& tape = *model.tape;
  beam.table.required_choice("deformation", {"quadratic"});
  const Expr L = read_size(beam, "length", units::m, "write it in m", reading);
  const Expr rhoA = read_size(beam, "mass_per_length", units::kg / units::m, "write it in kg/m", reading);
  const Expr EI =
      read_size(beam, "bending_stiffness", units::newton_m * units::m, "write it in N m^2", reading);
  const Damping damping = read_damping(beam, reading);
  read_modal_range(beam, L, reading);
  beam.table.report_unknown_keys();

  // the straight line of mass
  const Expr mass = rhoA * L;
  const Expr first = mass * L / Expr(2);
  const Expr second = mass * L * L / Expr(3);
  described.mass += mass;
  described.first_moment[0] += first;
  described.inertia[1] += second;
  described.inertia[2] += second;

  for (std::size_t plane = 0; plane < beam.planes.size(); ++plane) {
    const auto axis = static_cast<std::size_t>(beam.planes[plane]);
    for (int i = 0; i < beam.modes; ++i) {
      const CantileverMode shape = cantilever_mode(i + 1);
      const auto constant = [&](const Exact& value) { return Expr(tape, tape.constant(value)); };
      ModeDescription mode;
      mode.coordinate = beam.first_coordinate + static_cast<int>(plane) * beam.modes + i;
      mode.S = {0, 0, 0};
      mode.S[axis] = constant(shape.mean) * mass;  // rhoA L int phi dx
      mode.X_phi = {0, 0, 0, 0, 0, 0, 0, 0, 0};
      mode.X_phi[axis] = constant(shape.moment) * mass * L;  // rhoA L^2 int x phi dx, row x
      for (const int other_axis : beam.planes) {
        for (int j = 0; j < beam.modes; ++j) {
          std::array<Expr, 9> overlap = {0, 0, 0, 0, 0, 0, 0, 0, 0};
          if (i == j) overlap[3 * axis + static_cast<std::size_t>(other_axis)] = mass / Expr(4);
          mode.phi_phi.push_back(overlap);
        }
      }
      described.modes.push_back(mode);

      const Exact b2 = shape.b * shape.b;
      const Expr stiffness = constant(b2 * b2 / Exact(4)) * EI / (L * L * L);
      const auto coordinate = static_cast<std::size_t>(mode.coordinate);
      const Expr r(tape, model.symbols.r[coordinate]);
      const Expr rate(tape, model.symbols.r_dot[coordinate]);
      model.potential += stiffness * (r * r) / Expr(2);
      if (damping.modal) model.dissipation += *damping.modal * (rate * rate) / Expr(2);
      if (damping.material) model.dissipation += *damping.material * stiffness * (rate * rate) / Expr(2);
    }
  }
}

}  // namespace anholon
