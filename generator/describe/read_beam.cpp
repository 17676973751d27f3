// SPDX-License-Identifier: GPL-2.0-or-later
// An Euler-Bernoulli beam along the body's x axis: bending along y and z, torsion about x, stretch along x.
// Its cross-sections move along with the axis and turn about it: p = (X, y, z) + sum_j phi_j r_ej, with phi_j
// = f_j e_y, f_j e_z, f_j e_x x (0, y, z), f_j e_x. The foreshortening of bending is -1/2 int_0^X (v'^2 +
// w'^2), that of torsion -1/2 theta^2 (0, y, z).
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "describe/beam.hpp"
#include "describe/deformation.hpp"
#include "describe/names.hpp"
#include "describe/read_parts.hpp"
#include "tape/derivative.hpp"
#include "tape/interpret.hpp"

namespace anholon {
namespace {

Expr read_size(BeamOutline& beam, const Value& value, std::string_view key, Dimension unit,
               Reading& reading) {
  const std::string what = fmt::format("the {} of {}", key, beam.table.what());
  const std::size_t before = reading.findings.size();
  const Expr size = reading.number(value, what, unit);
  const Exact at_defaults = reading.at_defaults(size, value.where, what);
  if (reading.findings.size() == before && at_defaults <= Exact(0))
    reading.findings.error(value.where, fmt::format("{} is {}", what, at_defaults.decimal(8)),
                           "it must be positive");
  return reading.findings.size() == before ? size : Expr(1);
}

/// @param wanted  whether the modes need it; else it may be left out, and is 1
Expr read_size(BeamOutline& beam, std::string_view key, Dimension unit, std::string_view mend, bool wanted,
               Reading& reading) {
  const Value* value = wanted ? beam.table.required(key, mend) : beam.table.optional(key);
  return value == nullptr ? Expr(1) : read_size(beam, *value, key, unit, reading);
}

/// One stiffness for all planes, or one for each.
std::vector<Expr> read_bending_stiffness(BeamOutline& beam, Reading& reading) {
  const std::string_view key = "bending_stiffness";
  constexpr std::string_view mend = "write it in N m^2";
  const Dimension unit = units::newton_m * units::m;
  const Value* value = beam.table.table().find(key);
  if (value == nullptr || value->kind != Value::Kind::array)
    return std::vector<Expr>(beam.planes.size(), read_size(beam, key, unit, mend, beam.modes > 0, reading));
  beam.table.optional(key);
  std::vector<Expr> stiffness;
  for (const Value& item : value->items) stiffness.push_back(read_size(beam, item, key, unit, reading));
  if (stiffness.size() != beam.planes.size())
    reading.findings.error(value->where,
                           fmt::format("{} bends in {} planes but has {} bending stiffnesses",
                                       beam.table.what(), beam.planes.size(), stiffness.size()),
                           "write one number, or one for each plane");
  stiffness.resize(beam.planes.size(), Expr(1));
  return stiffness;
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
  if (modal != nullptr && beam.torsion_modes > 0) {
    reading.findings.error(modal->where,
                           fmt::format("{} has one modal_damping for lengths and angles", beam.table.what()),
                           "write material_damping in s");
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

/// Working range of a family of modes.
/// @param fraction  of the length (an angle: of a radian) that it is without a key
void read_modal_range(BeamOutline& beam, const char* key, std::size_t first, std::size_t count,
                      const std::optional<Expr>& length, int fraction, Reading& reading) {
  const Value* value = beam.table.optional(key);
  if (count == 0) return;
  const std::string what = fmt::format("the {} of {}", key, beam.table.what());
  std::array<Exact, 2> bounds;
  if (value != nullptr) {
    const auto read = reading.range(*value, what, length ? units::m : units::one);
    if (!read) return;
    bounds = *read;
  } else {
    const Exact unit = length ? reading.at_defaults(*length, beam.table.table().where, what) : Exact(1);
    bounds[1] = unit / Exact(fraction);
    bounds[0] = -bounds[1];
    const std::string of = fraction == 5 ? "a fifth" : fraction == 2 ? "a half" : "a hundredth";
    reading.model.notes.push_back(fmt::format("{} is taken as {} of {}, [{}, {}] {}", what, of,
                                              length ? "its length" : "a radian", bounds[0].decimal(8),
                                              bounds[1].decimal(8), length ? "m" : "rad"));
  }
  for (std::size_t i = 0; i < count; ++i) {
    Coordinate& coordinate =
        reading.model.coordinates[static_cast<std::size_t>(beam.first_coordinate) + first + i];
    coordinate.lower = bounds[0];
    coordinate.upper = bounds[1];
  }
}

/// Bending shapes: the user's own, or those of the boundary conditions.
std::vector<BeamShape> read_shapes(BeamOutline& beam, Reading& reading) {
  static const std::vector<std::string> all_ends = {"clamped-free", "pinned-pinned"};
  std::vector<BeamShape> shapes;
  const auto ends = beam.table.optional_choice("ends", all_ends);
  const Value* own = beam.table.optional("shapes", Value::Kind::array);
  const Value* tip = beam.table.optional("tip", Value::Kind::table);
  if (own != nullptr && (ends || tip != nullptr)) {
    reading.findings.error(own->where,
                           fmt::format("{} has shapes and {}", beam.table.what(), ends ? "ends" : "a tip"),
                           "shapes bring their own ends; keep one");
    return shapes;
  }
  if (own != nullptr) {
    if (own->items.size() > static_cast<std::size_t>(beam.modes))
      reading.findings.error(own->where,
                             fmt::format("{} has {} shapes", beam.table.what(), own->items.size()),
                             fmt::format("write {} at most", beam.modes));
    for (const Value& item : own->items) {
      const std::string what = fmt::format("a shape of {}", beam.table.what());
      const auto shape = read_function_of_x(item, what, reading);
      if (!shape) return shapes;
      const std::array<Exact, 3> root = (*shape)(Exact(0));
      if (!root[0].is_zero())
        reading.findings.error(item.where, fmt::format("{} is {} at the root", what, root[0].decimal(4)),
                               "the body's frame is at the root: a shape begins with 0 there");
      shapes.push_back(*shape);
    }
    return shapes;
  }
  std::array<Exact, 2> ratios = {0, 0};
  if (tip != nullptr) {
    TableReader table(*tip, fmt::format("the tip of {}", beam.table.what()), reading.findings);
    for (const std::size_t i : {0U, 1U}) {
      const Value* value = table.optional(i == 0 ? "mass" : "inertia");
      if (value == nullptr) continue;
      const auto number = decimal_value(*value);
      if (!number || *number < Exact(0)) {
        reading.findings.error(
            value->where, fmt::format("a ratio of {} is not a decimal number from 0", table.what()),
            "write mass in units of mass_per_length length, inertia of mass_per_length length^3");
      } else {
        ratios[i] = *number;
      }
    }
    table.report_unknown_keys();
    if (ends == 1U) {
      reading.findings.error(tip->where, fmt::format("{} has a tip but is pinned there", beam.table.what()),
                             "remove it");
      return shapes;
    }
  }
  for (int i = 1; i <= beam.modes; ++i)
    shapes.push_back(ends == 1U ? pinned_shape(i) : clamped_shape(clamped_mode(i, ratios[0], ratios[1])));
  return shapes;
}

/// [[body.beam.section]]: parts with properties that change along x.
std::vector<BeamSection> read_sections(BeamOutline& beam, Reading& reading) {
  std::vector<BeamSection> sections;
  Exact from = 0;
  for (const Value* item : tables_of(beam.table, "section", reading.findings)) {
    TableReader table(*item, fmt::format("a section of {}", beam.table.what()), reading.findings);
    BeamSection section;
    if (const Value* to = table.optional("to")) {
      const auto end = decimal_value(*to);
      if (!end || *end <= from || *end > Exact(1)) {
        reading.findings.error(to->where, fmt::format("{} ends at '{}'", table.what(), to->text),
                               "write where it ends as a fraction of the length, beyond the one before");
        return {BeamSection{}};
      }
      section.to = *end;
    }
    const auto factor = [&](const char* key) -> BeamSection::Factor {
      const Value* value = table.optional(key);
      if (value == nullptr) return {};
      const auto f = read_function_of_x(*value, fmt::format("the {} of {}", key, table.what()), reading);
      if (!f) return {};
      return [shape = *f](const Exact& x) { return shape(x)[0]; };
    };
    section.mass = factor("mass");
    section.bending_y = section.bending_z = factor("bending");
    if (auto own = factor("bending_y")) section.bending_y = own;
    if (auto own = factor("bending_z")) section.bending_z = own;
    section.torsion = factor("torsion");
    section.axial = factor("axial");
    section.polar_inertia = factor("polar_inertia");
    table.report_unknown_keys();
    from = section.to;
    sections.push_back(std::move(section));
  }
  if (sections.empty()) sections.emplace_back();
  if (sections.back().to != Exact(1)) {
    reading.findings.error(
        beam.table.find_where("section"),
        fmt::format("the sections of {} end at {}", beam.table.what(), sections.back().to.decimal(8)),
        "let the last one end at 1");
    sections.back().to = 1;
  }
  return sections;
}

std::size_t axis_of(BeamFamily family) {
  return family == BeamFamily::bending_y ? 1 : family == BeamFamily::bending_z ? 2 : 0;
}

/// Slope per deflection turns y about z and z about -y.
std::array<Expr, 3> turn_of(BeamFamily family, const Expr& value, const Expr& slope) {
  if (family == BeamFamily::bending_y) return {0, 0, slope};
  if (family == BeamFamily::bending_z) return {0, -slope, 0};
  if (family == BeamFamily::torsion) return {value, 0, 0};
  return {0, 0, 0};
}

/// The frame of a place on the axis: x = 0.5 is half way.
BeamLine line_of(const std::vector<BeamMode>& modes, int first_coordinate, const Expr& length) {
  const auto at = [modes, first_coordinate, length](const Exact& x, Reading& reading) {
    StationDescription result;
    const WorkingDigits digits(128);
    Tape& tape = *reading.model.tape;
    const auto constant = [&](const Exact& value) { return Expr(tape, tape.constant(value)); };
    result.at = {constant(x) * length, 0, 0};
    const std::vector<std::vector<Exact>> shortening = shortening_up_to(x, modes);
    for (std::size_t j = 0; j < modes.size(); ++j) {
      StationDescription::Mode mode;
      mode.coordinate = first_coordinate + static_cast<int>(j);
      const BeamFamily family = modes[j].family;
      const std::array<Exact, 3> f = modes[j].shape(x.as_float());
      const Expr value = constant(snapped(f[0]));
      if (family != BeamFamily::torsion) mode.phi[axis_of(family)] = value;
      mode.turn = turn_of(family, value, constant(snapped(f[1])) / length);
      for (std::size_t l = 0; l < modes.size(); ++l) {
        std::array<Expr, 3> psi = {0, 0, 0};
        if (bends(family) && modes[l].family == family) psi[0] = -(constant(shortening[j][l]) / length);
        mode.psi.push_back(psi);
      }
      result.modes.push_back(std::move(mode));
    }
    return result;
  };
  return {length, at};
}

/// Where a child hangs: station = 0.5 is half way.
StationReader station_reader(const BeamLine& line) {
  return [line](const Value* station, const BodyDescription& hanging, Reading& reading) {
    Exact x = 1;
    if (station != nullptr) {
      const auto number = decimal_value(*station);
      if (!number || *number < Exact(0) || *number > Exact(1)) {
        reading.findings.error(
            station->where, fmt::format("the station of body '{}' is not a number from 0 to 1", hanging.name),
            "write the fraction of the beam's length at which it hangs");
        return StationDescription();
      }
      x = *number;
    }
    return line.at(x, reading);
  };
}

}  // namespace

std::optional<BeamShape> read_function_of_x(const Value& value, const std::string& what, Reading& reading) {
  const auto tape = std::make_shared<Tape>();
  const NodeId x = tape->input("x");
  Scope scope;
  scope.add("x", Symbol{SymbolKind::coordinate, {Expr(*tape, x), units::one}, "", ""});
  const std::string text = value.kind == Value::Kind::number ? decimal_text(value) : value.text;
  if (text.empty() || (value.kind != Value::Kind::number && value.kind != Value::Kind::string)) {
    reading.findings.error(value.where, fmt::format("{} is {}", what, value.kind_name()),
                           "write a number, or an expression of x in quotes");
    return std::nullopt;
  }
  try {
    const NodeId f = read_expression(*tape, text, scope, SymbolKind::coordinate).value.id(*tape);
    const NodeId first = derivative(*tape, f, x);
    const std::vector<NodeId> roots = {f, first, derivative(*tape, first, x)};
    return [tape, roots](const Exact& at) {
      const std::vector<Exact> values = interpret<Exact>(*tape, roots, std::vector<Exact>{at});
      return std::array<Exact, 3>{values[0], values[1], values[2]};
    };
  } catch (const ExpressionError& error) {
    reading.findings.error(value.at(error.offset), error.fact, error.mend);
  } catch (const std::domain_error& error) {
    reading.findings.error(value.where, fmt::format("{} is undefined: {}", what, error.what()),
                           "write a function that is defined for x from 0 to 1");
  }
  return std::nullopt;
}

void read_station(BodyOutline& body, BodyDescription& described, const BodyOutline* parent,
                  Reading& reading) {
  const Value* station = body.table.optional("station");
  if (described.parent < 0) return;
  if (parent != nullptr && parent->station_on) {
    described.station = parent->station_on(station, described, reading);
  } else if (station != nullptr &&
             (parent == nullptr ||
              (!parent->beam && !parent->modal))) {  // else the beam has errors of its own
    reading.findings.error(station->where,
                           fmt::format("{} has a station but hangs on a rigid body", body.table.what()),
                           "write its place as pose = { translation = ... }");
  }
}

void read_beam(BodyOutline& body, BodyDescription& described, Reading& reading) {
  if (!body.beam) return;
  BeamOutline& beam = *body.beam;
  Model& model = reading.model;
  Tape& tape = *model.tape;
  const std::size_t before = reading.findings.size();
  if (const auto deformation = beam.table.optional_choice("deformation", deformation_names()))
    described.deformation = static_cast<Deformation>(*deformation);
  const bool twists = beam.torsion_modes > 0;
  const Expr L = read_size(beam, "length", units::m, "write it in m", true, reading);
  const Expr rhoA =
      read_size(beam, "mass_per_length", units::kg / units::m, "write it in kg/m", true, reading);
  const std::vector<Expr> EI = read_bending_stiffness(beam, reading);
  const Dimension force = units::newton;
  const Expr GJ =
      read_size(beam, "torsion_stiffness", force * units::m * units::m, "write it in N m^2", twists, reading);
  const Expr EA = read_size(beam, "axial_stiffness", force, "write it in N", beam.axial_modes > 0, reading);
  const bool is_thick = twists || beam.table.table().find("polar_inertia") != nullptr;
  Expr rhoJ =
      read_size(beam, "polar_inertia", units::kg * units::m, "write it in kg m^2 per m", twists, reading);
  if (!is_thick) rhoJ = 0;
  const Damping damping = read_damping(beam, reading);
  const std::size_t bending = static_cast<std::size_t>(beam.modes) * beam.planes.size();
  const auto torsion = static_cast<std::size_t>(beam.torsion_modes);
  const auto axial = static_cast<std::size_t>(beam.axial_modes);
  read_modal_range(beam, "range", 0, bending, L, 5, reading);
  read_modal_range(beam, "torsion_range", bending, torsion, std::nullopt, 2, reading);
  read_modal_range(beam, "axial_range", bending + torsion, axial, L, 100, reading);
  const std::vector<BeamShape> shapes = read_shapes(beam, reading);
  const std::vector<BeamSection> sections = read_sections(beam, reading);
  beam.table.report_unknown_keys();
  if (reading.findings.size() > before) return;

  std::vector<BeamMode> modes;
  std::vector<Expr> stiffness;  // EI/L^3, GJ/L or EA/L
  for (std::size_t plane = 0; plane < beam.planes.size(); ++plane) {
    for (const BeamShape& shape : shapes) {
      modes.push_back({beam.planes[plane] == 1 ? BeamFamily::bending_y : BeamFamily::bending_z, shape});
      stiffness.push_back(EI[plane] / (L * L * L));
    }
  }
  for (int i = 1; i <= beam.torsion_modes; ++i) {
    modes.push_back({BeamFamily::torsion, fixed_free_shape(i)});
    stiffness.push_back(GJ / L);
  }
  for (int i = 1; i <= beam.axial_modes; ++i) {
    modes.push_back({BeamFamily::axial, fixed_free_shape(i)});
    stiffness.push_back(EA / L);
  }
  BeamIntegrals I;
  try {
    I = beam_integrals(modes, sections);
  } catch (const std::domain_error& error) {
    reading.findings.error(beam.table.find_where("section"),
                           fmt::format("{}: {}", beam.table.what(), error.what()),
                           "sections and shapes need to be defined, and sections positive, from 0 to 1");
    return;
  }
  const auto constant = [&](const Exact& value) { return Expr(tape, tape.constant(value)); };

  // undeformed: the line of mass, and the cross-sections, alike in y and z
  const Expr mass = rhoA * L;
  const Expr polar = rhoJ * L;
  const Expr second = constant(I.mass[2]) * mass * L * L + constant(I.polar) * polar / Expr(2);
  described.mass += constant(I.mass[0]) * mass;
  described.first_moment[0] += constant(I.mass[1]) * mass * L;
  described.inertia[0] += constant(I.polar) * polar;
  described.inertia[1] += second;
  described.inertia[2] += second;

  const auto entry = [](std::size_t row, std::size_t column) { return 3 * row + column; };
  for (std::size_t j = 0; j < modes.size(); ++j) {
    const BeamFamily family = modes[j].family;
    const std::size_t axis = axis_of(family);
    ModeDescription mode;
    mode.coordinate = beam.first_coordinate + static_cast<int>(j);
    mode.family = static_cast<int>(family);
    mode.S = {0, 0, 0};
    mode.X_phi.fill(0);
    if (family == BeamFamily::torsion) {  // int (0, y, z) (0, -z, y)^T dm
      mode.X_phi[entry(1, 2)] = constant(I.mean[j]) * polar / Expr(2);
      mode.X_phi[entry(2, 1)] = -mode.X_phi[entry(1, 2)];
    } else {
      mode.S[axis] = constant(I.mean[j]) * mass;
      mode.X_phi[entry(0, axis)] = constant(I.moment[j]) * mass * L;
    }
    for (std::size_t l = 0; l < modes.size(); ++l) {
      const BeamFamily other = modes[l].family;
      const Expr overlap = constant(I.overlap[j][l]);
      std::array<Expr, 9> phi_phi, X_psi;
      phi_phi.fill(0), X_psi.fill(0);
      std::array<Expr, 3> psi = {0, 0, 0};
      if (family == BeamFamily::torsion && other == family) {
        phi_phi[entry(1, 1)] = phi_phi[entry(2, 2)] = overlap * polar / Expr(2);
        X_psi[entry(1, 1)] = X_psi[entry(2, 2)] = -phi_phi[entry(1, 1)];
      } else if (family != BeamFamily::torsion && other != BeamFamily::torsion) {
        phi_phi[entry(axis, axis_of(other))] = overlap * mass;
        psi[0] = -(constant(I.shortening[j][l]) * rhoA);
        X_psi[entry(0, 0)] = -(constant(I.shortening_moment[j][l]) * mass);
      }
      mode.phi_phi.push_back(phi_phi);
      mode.psi.push_back(psi);
      mode.X_psi.push_back(X_psi);
    }
    described.modes.push_back(std::move(mode));

    const Expr r(tape, model.symbols.r[static_cast<std::size_t>(beam.first_coordinate) + j]);
    const Expr rate(tape, model.symbols.r_dot[static_cast<std::size_t>(beam.first_coordinate) + j]);
    if (damping.modal) model.dissipation += *damping.modal * (rate * rate) / Expr(2);
    for (std::size_t l = 0; l <= j; ++l) {
      const Expr k = constant(l == j ? I.stiffness[j][l] / Exact(2) : I.stiffness[j][l]) * stiffness[j];
      const std::size_t at = static_cast<std::size_t>(beam.first_coordinate) + l;
      const Expr r_l(tape, model.symbols.r[at]), rate_l(tape, model.symbols.r_dot[at]);
      model.potential += k * (r * r_l);
      if (damping.material) model.dissipation += *damping.material * k * (rate * rate_l);
    }
  }
  body.line = line_of(modes, beam.first_coordinate, L);
  body.station_on = station_reader(*body.line);
}

}  // namespace anholon
