// SPDX-License-Identifier: GPL-2.0-or-later
// What a fluid at rest does to a body: at a point of it, along a line in it, or along a beam. Lines are taken
// by Gauss quadrature: a section of a rigid body is a point of it, one of a beam a body without mass that
// hangs there.
#include <fmt/format.h>

#include <algorithm>

#include "describe/names.hpp"
#include "describe/read_parts.hpp"
#include "number/quadrature.hpp"

namespace anholon {
namespace {

/// Along and about the axes of the body: x, y, z of each.
using Six = std::array<Expr, 6>;

/// Where the fluid acts, with the share of the element's figures that acts there: 1, or a length in m.
struct Place {
  int body = 0;
  std::array<Expr, 3> point = {0, 0, 0};
  Expr share = 1;
};

/// Bodies without mass at places of beams. Elements that meet at a place share its body.
class BeamSections {
 public:
  int at(int beam, const BeamLine& line, const Exact& x, Reading& reading) {
    for (const Section& s : sections_) {
      if (s.beam == beam && s.x == x) return s.body;
    }
    Model& model = reading.model;
    BodyDescription body;
    const BodyDescription& carrier = model.bodies[static_cast<std::size_t>(beam)];
    for (int number = 1; body.name.empty() || body_index(model, body.name) >= 0; ++number)
      body.name = fmt::format("{}_section_{}", carrier.name, number);
    body.parent = beam;
    body.where = carrier.where;
    body.station = line.at(x, reading);
    model.bodies.push_back(std::move(body));
    sections_.push_back({beam, x, static_cast<int>(model.bodies.size()) - 1});
    return sections_.back().body;
  }

 private:
  struct Section {
    int beam;
    Exact x;
    int body;
  };
  std::vector<Section> sections_;
};

class FluidReader {
 public:
  FluidReader(TableReader& table, const Outline& outline, int first_outlined, BeamSections& sections,
              Reading& reading)
      : table_(table), sections_(sections), reading_(reading), before_(reading.findings.size()) {
    const auto body = read_body(table, "body", reading);
    if (!body) return;
    body_ = *body;
    if (body_ < first_outlined) return;
    const BodyOutline& outlined = outline.bodies[static_cast<std::size_t>(body_ - first_outlined)];
    if (outlined.line) beam_ = &*outlined.line;
    if (outlined.modal)
      reading.findings.error(table.find_where("body"),
                             fmt::format("'{}' is compliant by a table of modes", name()),
                             "let a body without mass hang at one of its stations, and name that");
  }

  void read() {
    read_places();
    read_forces();
    table_.report_unknown_keys();
    if (body_ < 0 || reading_.findings.size() > before_) return;
    for (const Place& place : places_) act(place);
  }

 private:
  [[nodiscard]] const std::string& name() const {
    return reading_.model.bodies[static_cast<std::size_t>(body_)].name;
  }
  [[nodiscard]] std::string what(std::string_view key) const {
    return fmt::format("the {} of {}", key, table_.what());
  }
  [[nodiscard]] Expr constant(const Exact& x) const {
    Tape& tape = *reading_.model.tape;
    return {tape, tape.constant(x)};
  }
  void refuse(const Value& at, const std::string& fact, const std::string& mend) {
    reading_.findings.error(at.where, fact, mend);
  }

  // ---- places
  // --------------------------------------------------------------------------------------------------
  void read_places() {
    const Value* point = table_.optional("point");
    const Value* from = table_.optional("from");
    const Value* to = table_.optional("to");
    const Value* profile = table_.optional("profile");
    const Value* count = table_.optional("sections");
    const int points = table_.optional_integer("sections", 1, 40).value_or(4);
    is_line_ = beam_ != nullptr || from != nullptr || to != nullptr;
    if (body_ < 0) return;
    if (point != nullptr && is_line_)
      return refuse(*point,
                    beam_ != nullptr
                        ? fmt::format("'{}' is a beam, of which {} takes a point", name(), table_.what())
                        : fmt::format("{} has a point and a line", table_.what()),
                    beam_ != nullptr ? "let a body without mass hang at that station, and name it"
                                     : "keep 'point', or 'from' and 'to'");
    if (!is_line_) {
      for (const Value* value : {profile, count}) {
        if (value != nullptr)
          refuse(*value, fmt::format("{} acts at a point and has sections or a profile", table_.what()),
                 "write 'from' and 'to', the ends of a line");
      }
      Place place;
      place.body = body_;
      if (point != nullptr) place.point = reading_.vector3(*point, what("point"), units::m);
      places_.push_back(place);
      return;
    }
    if (beam_ == nullptr && (from == nullptr || to == nullptr))
      return refuse(from == nullptr ? *to : *from, fmt::format("{} has one end only", table_.what()),
                    "write 'from' and 'to'");
    const std::vector<Exact> factors = read_profile(profile, points);
    if (reading_.findings.size() > before_) return;
    if (beam_ != nullptr) {
      place_along_beam(from, to, points, factors);
    } else {
      place_along_line(*from, *to, points, factors);
    }
  }

  /// Weight of each section, times the profile there.
  std::vector<Exact> read_profile(const Value* profile, int points) {
    const WorkingDigits digits(128);
    std::vector<Exact> factors;
    const auto function =
        profile == nullptr ? std::nullopt : read_function_of_x(*profile, what("profile"), reading_);
    for (const QuadraturePoint& q : gauss_legendre(points)) {
      Exact factor = 1;
      try {
        if (function) factor = (*function)(q.x)[0];
      } catch (const std::domain_error& error) {
        refuse(*profile, fmt::format("{} is undefined: {}", what("profile"), error.what()),
               "write a function that is defined for x from 0 to 1");
        return factors;
      }
      if (factor < Exact(0)) {
        refuse(*profile,
               fmt::format("{} is {} at x = {}", what("profile"), factor.decimal(4), q.x.decimal(4)),
               "it must not be negative");
        return factors;
      }
      factors.push_back(q.weight * factor);
    }
    return factors;
  }

  void place_along_line(const Value& from, const Value& to, int points, const std::vector<Exact>& factors) {
    const std::array<Expr, 3> a = reading_.vector3(from, what("from"), units::m);
    const std::array<Expr, 3> b = reading_.vector3(to, what("to"), units::m);
    std::array<Expr, 3> d;
    for (std::size_t i = 0; i < 3; ++i) d[i] = b[i] - a[i];
    const Expr square = dot(d, d);
    if (reading_.at_defaults(square, to.where, what("to")).is_zero())
      return refuse(to, fmt::format("the line of {} has no length", table_.what()), "move one of its ends");
    // along a coordinate axis the length needs no root
    Expr length = sqrt(square);
    for (std::size_t i = 0; i < 3; ++i) {
      if (!d[(i + 1) % 3].is_zero() || !d[(i + 2) % 3].is_zero()) continue;
      length = reading_.at_defaults(d[i], to.where, what("to")) < Exact(0) ? -d[i] : d[i];
    }
    const WorkingDigits digits(128);
    const std::vector<QuadraturePoint> rule = gauss_legendre(points);
    for (std::size_t q = 0; q < rule.size(); ++q) {
      Place place;
      place.body = body_;
      for (std::size_t i = 0; i < 3; ++i) place.point[i] = a[i] + constant(rule[q].x) * d[i];
      place.share = constant(factors[q]) * length;
      places_.push_back(place);
    }
  }

  void place_along_beam(const Value* from, const Value* to, int points, const std::vector<Exact>& factors) {
    const auto fraction = [&](const Value* value, const Exact& otherwise) {
      if (value == nullptr) return otherwise;
      const auto number = decimal_value(*value);
      if (number && *number >= Exact(0) && *number <= Exact(1)) return *number;
      refuse(*value, fmt::format("an end of {} is not a number from 0 to 1", table_.what()),
             "write fractions of the beam's length");
      return otherwise;
    };
    const Exact a = fraction(from, 0), b = fraction(to, 1);
    if (a >= b && reading_.findings.size() == before_)
      refuse(to != nullptr ? *to : *from, fmt::format("{} ends where it begins, or before", table_.what()),
             "'from' is nearer to the root than 'to'");
    if (reading_.findings.size() > before_) return;
    const WorkingDigits digits(128);
    const std::vector<QuadraturePoint> rule = gauss_legendre(points);
    for (std::size_t q = 0; q < rule.size(); ++q) {
      Place place;
      place.body = sections_.at(body_, *beam_, a + rule[q].x * (b - a), reading_);
      place.share = constant(factors[q] * (b - a)) * beam_->length;
      places_.push_back(place);
    }
  }

  // ---- forces
  // --------------------------------------------------------------------------------------------------
  [[nodiscard]] Dimension unit_here(const Dimension& unit) const { return is_line_ ? unit / units::m : unit; }

  Expr read_amount(const Value& value, std::string_view key, const Dimension& unit) {
    const std::size_t before = reading_.findings.size();
    const Expr x = reading_.number(value, what(key), unit_here(unit));
    const Exact at_defaults = reading_.at_defaults(x, value.where, what(key));
    if (reading_.findings.size() == before && at_defaults < Exact(0))
      refuse(value, fmt::format("an entry of {} is {}", what(key), at_defaults.decimal(8)),
             "it must not be negative");
    return x;
  }

  /// Three numbers along the axes, or six along and about them.
  std::optional<Six> read_six(std::string_view key, const Dimension& along, const Dimension& about) {
    const Value* value = table_.optional(key);
    if (value == nullptr) return std::nullopt;
    Six six = {0, 0, 0, 0, 0, 0};
    const std::size_t size = value->items.size();
    if (value->kind != Value::Kind::array || (size != 3 && size != 6)) {
      refuse(*value, fmt::format("{} is not an array of three or six", what(key)),
             "write it along x, y and z; then, if needed, about x, y and z");
      return six;
    }
    for (std::size_t i = 0; i < size; ++i) six[i] = read_amount(value->items[i], key, i < 3 ? along : about);
    return six;
  }

  void read_forces() {
    read_added_mass();
    drag_ = read_six("drag", units::kg / units::m, units::kg_m2);
    resistance_ = read_six("resistance", units::kg / units::s, units::kg_m2 / units::s);
    if (const Value* displaced = table_.optional("displaced_mass"))
      displaced_ = read_amount(*displaced, "displaced_mass", units::kg);
    read_wake();
    if (table_.table().find("wake") == nullptr && !added_mass_ && !drag_ && !resistance_ && !displaced_)
      reading_.findings.error(table_.table().where, fmt::format("{} does nothing", table_.what()),
                              "give it an added_mass, drag, resistance, displaced_mass or wake");
  }

  void read_added_mass() {
    const std::string_view key = "added_mass";
    const Value* value = table_.table().find(key);
    const bool full = value != nullptr && value->kind == Value::Kind::array && value->items.size() == 6 &&
                      value->items[0].kind == Value::Kind::array;
    if (!full) {
      if (const auto six = read_six(key, units::kg, units::kg_m2)) {
        AddedMass<Expr> mass;
        for (std::size_t i = 0; i < 3; ++i) {
          mass.A.diagonal[static_cast<int>(i)] = (*six)[i];
          mass.C.diagonal[static_cast<int>(i)] = (*six)[3 + i];
        }
        added_mass_ = mass;
      }
      return;
    }
    table_.optional(key);
    std::vector<std::vector<Expr>> M;
    std::vector<std::vector<Exact>> values;
    for (std::size_t i = 0; i < 6; ++i) {
      const Value& row = value->items[i];
      M.emplace_back(6, Expr(0)), values.emplace_back(6, Exact(0));
      if (row.kind != Value::Kind::array || row.items.size() != 6) {
        refuse(row, fmt::format("row {} of {} is not an array of six", i + 1, what(key)),
               "write six rows of six numbers: of V_x, V_y, V_z, Omega_x, Omega_y, Omega_z");
        continue;
      }
      for (std::size_t j = 0; j < 6; ++j) {
        const Dimension unit = i < 3 && j < 3 ? units::kg : i < 3 || j < 3 ? units::kg_m : units::kg_m2;
        M[i][j] = reading_.number(row.items[j], fmt::format("an entry of {}", what(key)), unit_here(unit));
        values[i][j] = reading_.at_defaults(M[i][j], row.items[j].where, what(key));
      }
    }
    added_mass_ = AddedMass<Expr>();
    if (reading_.findings.size() > before_) return;
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (values[i][j] == values[j][i]) continue;
        return refuse(
            value->items[i].items[j],
            fmt::format("{} is not symmetric: entry ({}, {}) is {}, entry ({}, {}) is {}", what(key), i + 1,
                        j + 1, values[i][j].decimal(8), j + 1, i + 1, values[j][i].decimal(8)),
            "write the same on both sides of the diagonal");
      }
    }
    if (!is_semidefinite(values))
      return refuse(*value, fmt::format("{} is not positive semidefinite", what(key)),
                    "the energy of a fluid is not negative; check signs and the point that it refers to");
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
        if (j >= i) added_mass_->A(i, j) = M[a][b], added_mass_->C(i, j) = M[3 + a][3 + b];
        added_mass_->B(i, j) = M[a][3 + b];
      }
    }
  }

  void read_wake() {
    const Value* value = table_.optional("wake", Value::Kind::table);
    if (value == nullptr) return;
    TableReader table(*value, what("wake"), reading_.findings);
    const Value* mass = table.required("added_mass", Value::Kind::array,
                                       "write that of the last section, along y and z, in kg/m");
    const auto forward = table.required_choice("forward", {"x", "-x"});
    table.report_unknown_keys();
    if (is_line_) {
      refuse(
          *value, fmt::format("{} sheds a wake along a line", table_.what()),
          "a wake leaves at the tail: write it for a point, with 'point' or on a body that hangs at the tip");
      return;
    }
    if (mass == nullptr || !forward) return;
    if (mass->items.size() != 2) {
      refuse(*mass, fmt::format("the added_mass of {} is not an array of two", table.what()),
             "write it along y and z, in kg/m");
      return;
    }
    const Dimension unit = units::kg / units::m;
    wake_ = std::array<Expr, 3>{*forward == 0 ? Expr(1) : Expr(-1), read_amount(mass->items[0], "wake", unit),
                                read_amount(mass->items[1], "wake", unit)};
  }

  // ---- what acts at a place
  // --------------------------------------------------------------------------------------------------
  void act(const Place& place) {
    BodyDescription& body = reading_.model.bodies[static_cast<std::size_t>(place.body)];
    const Vec3<Expr> at = {place.point[0], place.point[1], place.point[2]};
    if (added_mass_ || displaced_) {
      AddedMass<Expr> mass = added_mass_.value_or(AddedMass<Expr>());
      mass.displaced = displaced_.value_or(Expr(0));
      for (Vec3<Expr>* v : {&mass.A.diagonal, &mass.A.mixed, &mass.C.diagonal, &mass.C.mixed})
        *v = place.share * *v;
      mass.B = place.share * mass.B;
      mass.displaced = place.share * mass.displaced;
      const AddedMass<Expr> moved = mass.moved(at);
      body.fluid = body.fluid ? *body.fluid + moved : moved;
    }
    if (drag_ || resistance_) {  // F_i = -(c_i + k_i |v_i|) v_i, torques likewise
      WrenchDescription wrench = wrench_at(place);
      wrench.dissipates = true;
      const std::array<Expr, 6> v = local_velocity(reading_);
      for (std::size_t i = 0; i < 6; ++i) {
        Expr coefficient = resistance_ ? (*resistance_)[i] : Expr(0);
        if (drag_) coefficient = coefficient + (*drag_)[i] * abs(v[i]);
        (i < 3 ? wrench.force : wrench.torque)[i % 3] = -(place.share * coefficient * v[i]);
      }
      reading_.model.wrenches.push_back(wrench);
    }
    if (wake_) {  // F = -u m w + m w^2/2 forward, with u the velocity forward and w that across
      WrenchDescription wrench = wrench_at(place);
      const std::array<Expr, 6> v = local_velocity(reading_);
      const auto& [forward, m_y, m_z] = *wake_;
      wrench.force[0] = forward * (m_y * (v[1] * v[1]) + m_z * (v[2] * v[2])) / Expr(2);
      wrench.force[1] = -(forward * (m_y * (v[0] * v[1])));
      wrench.force[2] = -(forward * (m_z * (v[0] * v[2])));
      reading_.model.wrenches.push_back(wrench);
    }
  }

  static WrenchDescription wrench_at(const Place& place) {
    WrenchDescription wrench;
    wrench.body = place.body;
    wrench.point = place.point;
    return wrench;
  }

  TableReader& table_;
  BeamSections& sections_;
  Reading& reading_;
  std::size_t before_;
  int body_ = -1;
  const BeamLine* beam_ = nullptr;
  bool is_line_ = false;
  std::vector<Place> places_;
  std::optional<AddedMass<Expr>> added_mass_;
  std::optional<Six> drag_, resistance_;
  std::optional<Expr> displaced_;
  std::optional<std::array<Expr, 3>> wake_;  // forward along x, +1 or -1; added mass along y and z
};

}  // namespace

void read_fluids(TableReader& root, const Outline& outline, int first_outlined, Reading& reading) {
  BeamSections sections;
  std::size_t number = 0;
  for (const Value* value : tables_of(root, "fluid", reading.findings)) {
    TableReader table(*value, fmt::format("fluid {}", ++number), reading.findings);
    FluidReader(table, outline, first_outlined, sections, reading).read();
  }
}

}  // namespace anholon
