// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/specialise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>

#include "tape/interpret.hpp"

namespace anholon {
namespace {

using Visitor = std::function<void(Expr&)>;

template <class Container>
void visit_all(Container& expressions, const Visitor& visit) {
  for (Expr& e : expressions) visit(e);
}

/// Every expression of a model.
void for_each_expression(Model& model, const Visitor& visit) {
  for (BodyDescription& body : model.bodies) {
    visit_all(body.R, visit);
    visit_all(body.p, visit);
    visit_all(body.joint.axis, visit);
    visit(body.joint.pitch);
    visit(body.joint.armature);
    visit(body.joint.displacement);
    visit(body.mass);
    visit_all(body.first_moment, visit);
    visit_all(body.inertia, visit);
    if (body.fluid) {
      AddedMass<Expr>& fluid = *body.fluid;
      for (Vec3<Expr>* v :
           {&fluid.A.diagonal, &fluid.A.mixed, &fluid.C.diagonal, &fluid.C.mixed, &fluid.displaced_moment})
        visit(v->x), visit(v->y), visit(v->z);
      visit_all(fluid.B.m, visit);
      visit(fluid.displaced);
    }
    for (ModeDescription& mode : body.modes) {
      visit_all(mode.S, visit);
      visit_all(mode.X_phi, visit);
      for (auto& overlap : mode.phi_phi) visit_all(overlap, visit);
      for (auto& psi : mode.psi) visit_all(psi, visit);
      for (auto& X_psi : mode.X_psi) visit_all(X_psi, visit);
    }
    visit_all(body.station.at, visit);
    for (StationDescription::Mode& mode : body.station.modes) {
      visit_all(mode.phi, visit);
      visit_all(mode.turn, visit);
      for (auto& psi : mode.psi) visit_all(psi, visit);
    }
  }
  for (RowDescription& row : model.rows) {
    for (RowTermDescription& term : row.terms) {
      visit_all(term.point, visit);
      visit_all(term.linear, visit);
      visit_all(term.angular, visit);
    }
    if (row.expression) visit(*row.expression);
  }
  for (PositionDescription& position : model.positions) visit(position.value);
  for (ContactForceDescription& contact : model.contact_forces) {
    for (ContactForceDescription::Share& share : contact.shares)
      visit(share.normal), visit(share.longitudinal), visit(share.lateral);
    if (contact.friction) visit(*contact.friction);
  }
  for (WrenchDescription& wrench : model.wrenches) {
    visit_all(wrench.point, visit);
    visit_all(wrench.force, visit);
    visit_all(wrench.torque, visit);
  }
  for (GeneralisedForceDescription& force : model.forces) visit(force.force);
  visit_all(model.gravity, visit);
  visit(model.potential);
  visit(model.dissipation);
}

/// Indices in a body of the modes that stay when `most` are kept in each family.
std::vector<std::size_t> kept_modes(const BodyDescription& body, int most) {
  std::vector<std::size_t> kept;
  std::map<int, int> count;
  for (std::size_t i = 0; i < body.modes.size(); ++i) {
    if (count[body.modes[i].family]++ < most) kept.push_back(i);
  }
  return kept;
}

/// Modes kept in each family of a body.
int modes_of(const Scene& scene, std::size_t body) {
  for (const auto& [index, kept] : scene.modes) {
    if (index == static_cast<int>(body)) return kept;
  }
  return 1 << 20;
}

/// The entries of a list, one for each mode of a body, that belong to modes that stay.
template <class T>
std::vector<T> picked(const std::vector<T>& list, const std::vector<std::size_t>& stay) {
  std::vector<T> result;
  for (const std::size_t i : stay) {
    if (!list.empty()) result.push_back(list[i]);
  }
  return result;
}

void drop_modes(Model& model, const Scene& scene, const std::vector<int>& new_index) {
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    BodyDescription& body = model.bodies[b];
    std::vector<std::size_t> stay;
    for (const std::size_t i : kept_modes(body, modes_of(scene, b))) {
      if (new_index[static_cast<std::size_t>(body.modes[i].coordinate)] >= 0)  // else locked at zero
        stay.push_back(i);
    }
    body.modes = picked(body.modes, stay);
    for (ModeDescription& mode : body.modes) {
      mode.coordinate = new_index[static_cast<std::size_t>(mode.coordinate)];
      mode.phi_phi = picked(mode.phi_phi, stay);
      mode.psi = picked(mode.psi, stay);
      mode.X_psi = picked(mode.X_psi, stay);
    }
    for (BodyDescription& child : model.bodies) {
      if (child.parent != static_cast<int>(b)) continue;
      child.station.modes = picked(child.station.modes, stay);
      for (StationDescription::Mode& mode : child.station.modes) {
        mode.coordinate = new_index[static_cast<std::size_t>(mode.coordinate)];
        mode.psi = picked(mode.psi, stay);
      }
    }
  }
}

/// What each input of the old tape becomes on the new one; makes the inputs of the new one.
std::vector<Expr> new_inputs(const Model& old, Model& model, const Scene& scene,
                             const std::vector<int>& new_index) {
  Tape& tape = *model.tape;
  StateSymbols& symbols = model.symbols;
  symbols = StateSymbols();
  std::vector<Expr> image(old.tape->inputs().size(), Expr(0));
  const auto becomes = [&](NodeId old_input, NodeId id) {
    image[old.tape->node(old_input).a] = Expr(tape, id);
  };
  const auto copied = [&](NodeId old_input) {
    const NodeId id = tape.input(old.tape->inputs()[old.tape->node(old_input).a]);
    becomes(old_input, id);
    return id;
  };
  model.parameters.clear();
  for (std::size_t i = 0; i < old.parameters.size(); ++i) {
    const Parameter& parameter = old.parameters[i];
    if (std::find(scene.frozen.begin(), scene.frozen.end(), parameter.name) != scene.frozen.end()) {
      becomes(old.symbols.parameters[i], tape.constant(parameter.value));
    } else {
      model.parameters.push_back(parameter);
      symbols.parameters.push_back(copied(old.symbols.parameters[i]));
    }
  }
  const auto rows_in_force = [&] { return scene.elasticity ? model.rows : std::vector<RowDescription>{}; };
  symbols.t = copied(old.symbols.t);
  for (std::size_t i = 0; i < 9; ++i) symbols.R[i] = copied(old.symbols.R[i]);
  for (std::size_t i = 0; i < 3; ++i) symbols.p[i] = copied(old.symbols.p[i]);
  model.coordinates.clear();
  for (std::size_t i = 0; i < old.coordinates.size(); ++i) {
    if (new_index[i] < 0) continue;
    model.coordinates.push_back(old.coordinates[i]);
    symbols.r.push_back(copied(old.symbols.r[i]));
  }
  for (const RowDescription& row : rows_in_force()) {
    Coordinate deflection;
    deflection.name = "deflection_" + row.name;
    deflection.lower = Exact::from_decimal("-1e-3"), deflection.upper = Exact::from_decimal("1e-3");
    model.coordinates.push_back(deflection);
    symbols.r.push_back(tape.input(deflection.name));
  }
  for (std::size_t i = 0; i < 6; ++i) symbols.eta[i] = copied(old.symbols.eta[i]);
  for (std::size_t i = 0; i < old.coordinates.size(); ++i) {
    if (new_index[i] >= 0) symbols.r_dot.push_back(copied(old.symbols.r_dot[i]));
  }
  for (const RowDescription& row : rows_in_force())
    symbols.r_dot.push_back(tape.input("deflection_" + row.name + "_dot"));
  for (const NodeId id : old.symbols.local) symbols.local.push_back(copied(id));
  for (const LockedCoordinate& locked : scene.locked) {  // their places depend on parameters alone
    const NodeId root = locked.value.id(*scene.model.tape);
    const Expr place = interpret<Expr>(*scene.model.tape, {root}, image, FromExact<Expr>{&tape}).front();
    const auto coordinate = static_cast<std::size_t>(locked.coordinate);
    becomes(old.symbols.r[coordinate], place.id(tape));
  }
  for (Expr& e : image) e = Expr(tape, e.id(tape));  // dropped modes and rates of what stands still: zero
  return image;
}

/// Whether a written row still holds a velocity.
bool has_velocity(const Model& model, const RowDescription& row) {
  if (!row.expression) return true;
  for (const NodeId id : model.tape->reachable({row.expression->id(*model.tape)})) {
    const auto& eta = model.symbols.eta;
    const auto& rates = model.symbols.r_dot;
    if (std::find(eta.begin(), eta.end(), id) != eta.end() ||
        std::find(rates.begin(), rates.end(), id) != rates.end())
      return true;
  }
  return false;
}

/// Rows give way by a deflection each, which a spring and a damper hold: eq. (26) then has one solution.
void make_elastic(Model& model, const ContactElasticity& elasticity) {
  Tape& tape = *model.tape;
  const Expr k(tape, tape.constant(elasticity.stiffness)), c(tape, tape.constant(elasticity.damping));
  model.deflections = model.rows.size();
  const std::size_t first = model.coordinates.size() - model.deflections;
  for (std::size_t i = 0; i < model.rows.size(); ++i) {
    const Expr e(tape, model.symbols.r[first + i]), rate(tape, model.symbols.r_dot[first + i]);
    std::optional<Expr>& row = model.rows[i].expression;
    row = row ? *row + rate : rate;
    model.potential += k / Expr(2) * e * e;
    model.dissipation += c / Expr(2) * rate * rate;
  }
  model.positions.clear();  // springs hold what they held
}

}  // namespace

std::vector<int> kept_coordinates(const Model& model, const Scene& scene) {
  std::vector<char> gone(model.coordinates.size(), 0);
  for (const LockedCoordinate& locked : scene.locked) gone[static_cast<std::size_t>(locked.coordinate)] = 1;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const BodyDescription& body = model.bodies[b];
    const std::vector<std::size_t> kept = kept_modes(body, modes_of(scene, b));
    for (std::size_t i = 0; i < body.modes.size(); ++i) {
      if (std::find(kept.begin(), kept.end(), i) == kept.end())
        gone[static_cast<std::size_t>(body.modes[i].coordinate)] = 1;
    }
  }
  std::vector<int> new_index;
  int next = 0;
  for (const char is_gone : gone) new_index.push_back(is_gone != 0 ? -1 : next++);
  return new_index;
}

Model specialise(const Model& old, const Scene& scene) {
  const std::vector<int> new_index = kept_coordinates(old, scene);
  Model model = old;
  model.tape = std::make_shared<Tape>();
  const std::vector<std::string> open = scene.open_contacts();
  const auto is_open = [&](const auto& part) {
    return std::find(open.begin(), open.end(), part.contact) != open.end();
  };
  std::erase_if(model.rows, is_open);
  std::erase_if(model.positions, is_open);
  std::erase_if(model.contact_forces, is_open);
  drop_modes(model, scene, new_index);
  for (BodyDescription& body : model.bodies) body.deformation = scene.deformation.value_or(body.deformation);
  if (!scene.gravity) model.gravity = {0, 0, 0};
  std::erase_if(model.forces, [&](GeneralisedForceDescription& force) {
    if (force.index < 6) return false;
    const int index = new_index[static_cast<std::size_t>(force.index - 6)];
    force.index = 6 + index;
    return index < 0;
  });
  try {
    const std::vector<Expr> image = new_inputs(old, model, scene, new_index);
    std::vector<Expr*> expressions;
    std::vector<NodeId> roots;
    for_each_expression(model, [&](Expr& e) {
      if (e.tape() == nullptr) return;
      expressions.push_back(&e);
      roots.push_back(e.id(*old.tape));
    });
    const std::vector<Expr> copies =
        interpret<Expr>(*old.tape, roots, image, FromExact<Expr>{model.tape.get()});
    for (std::size_t i = 0; i < copies.size(); ++i) *expressions[i] = copies[i];
    if (scene.elasticity) make_elastic(model, *scene.elasticity);
  } catch (const std::domain_error& error) {
    throw ModelError({scene.file, 0, 0},
                     fmt::format("frozen and locked values leave the model undefined: {}", error.what()),
                     "freeze other values, or fewer");
  }
  for (BodyDescription& body : model.bodies) {
    const auto found = std::find_if(old.coordinates.begin(), old.coordinates.end(),
                                    [&](const Coordinate& c) { return c.name == body.joint.coordinate; });
    if (found != old.coordinates.end() &&
        new_index[static_cast<std::size_t>(found - old.coordinates.begin())] < 0)
      body.joint.coordinate.clear();
  }
  std::erase_if(model.free_velocities, [&](const std::string& name) {
    const auto is_it = [&](const Coordinate& c) { return c.name == name; };
    return std::any_of(old.coordinates.begin(), old.coordinates.end(), is_it) &&
           std::none_of(model.coordinates.begin(), model.coordinates.end(), is_it);
  });
  std::erase_if(model.rows, [&](const RowDescription& row) {
    if (has_velocity(model, row)) return false;
    model.notes.push_back(fmt::format("constraint '{}' holds by itself in scene '{}'", row.name, scene.name));
    return true;
  });
  return model;
}

}  // namespace anholon
