// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/contact.hpp"

#include "anholon/recursion.hpp"
#include "describe/mechanise.hpp"
#include "tape/derivative.hpp"

namespace anholon {
namespace {

constexpr std::array<const char*, 3> axis_names = {"x", "y", "z"};

Vec3<Expr> vec3(const std::array<Expr, 3>& a) { return {a[0], a[1], a[2]}; }

/// Two of the coordinate axes whose products with `axis` span the plane across it.
std::array<Vec3<Expr>, 2> across(const Vec3<Expr>& axis) {
  for (int k = 0; k < 3; ++k) {  // an axis along a coordinate axis: the other two
    if (axis[(k + 1) % 3].is_zero() && axis[(k + 2) % 3].is_zero())
      return {unit<Expr>((k + 1) % 3), unit<Expr>((k + 2) % 3)};
  }
  for (int k = 0; k < 3; ++k) {  // else across the first coordinate axis that it leans away from
    if (!axis[k].is_zero()) continue;
    return {unit<Expr>(k), cross(axis, unit<Expr>(k))};
  }
  const Vec3<Expr> u = cross(axis, unit<Expr>(0));
  return {u, cross(axis, u)};
}

}  // namespace

ContactGeometry::ContactGeometry(const Model& model) : model_(model) {
  const std::shared_ptr<Tape>& tape = model.tape;
  const StateSymbols& s = model.symbols;
  const auto symbol = [&](NodeId id) { return Expr(*tape, id); };
  std::vector<Expr> parameters;
  for (const NodeId id : s.parameters) parameters.push_back(symbol(id));
  const MechanismDescription description = describe_mechanism(model);
  const Mechanism<Expr> mechanism = mechanise<Expr>(description, parameters, FromExact<Expr>{tape.get()});
  State<Expr> state;
  state.t = symbol(s.t);
  for (const NodeId id : s.r) state.r.push_back(symbol(id));
  for (const NodeId id : s.r_dot) state.r_dot.push_back(symbol(id));

  Recursion<Expr> recursion(mechanism);
  recursion.position(state);
  const auto frames = [&](bool moving) {
    recursion.twists(state);
    std::vector<Mat3<Expr>> R;
    std::vector<Vec3<Expr>> p;
    recursion.poses(state, R, p);
    std::vector<Frame> result;
    for (std::size_t k = 0; k < R.size(); ++k) {
      const Mat3<Expr>& own = mechanism.bodies[k].R_frame;
      Frame frame{R[k] * own, p[k], {}, {}};
      if (moving) {
        frame.v = transposed_times(own, recursion.motion(static_cast<int>(k)).v);
        frame.w = transposed_times(own, recursion.motion(static_cast<int>(k)).w);
      }
      result.push_back(frame);
    }
    return result;
  };
  internal_ = frames(false);
  for (const int c : free_components(model.group)) state.eta[c] = symbol(s.eta[static_cast<std::size_t>(c)]);
  if (model.group == GroupKind::SE2 || model.group == GroupKind::SE3 || model.group == GroupKind::SO3) {
    for (std::size_t i = 0; i < 9; ++i) state.R.m[i] = symbol(s.R[i]);
  }
  if (model.group == GroupKind::SE2) {  // turns about Z alone
    for (const std::size_t i : {2U, 5U, 6U, 7U}) state.R.m[i] = 0;
    state.R.m[8] = 1;
  }
  for (const int c : free_components(model.group)) {
    if (c < 3) state.p[c] = symbol(s.p[static_cast<std::size_t>(c)]);
  }
  world_ = frames(true);
}

Expr ContactGeometry::rate(const Expr& of_shape) const {
  Tape& tape = *model_.tape;
  std::vector<std::pair<NodeId, NodeId>> motion;
  for (std::size_t i = 0; i < model_.symbols.r.size(); ++i)
    motion.emplace_back(model_.symbols.r[i], model_.symbols.r_dot[i]);
  return {tape, directional_derivative(tape, {of_shape.id(tape)}, motion).front()};
}

ContactGeometry::Touch ContactGeometry::touch(const Wheel& wheel) const {
  const BodyDescription& body = model_.bodies[static_cast<std::size_t>(wheel.body)];
  const auto parallel = [&] {  // the joint turns about the axle
    const Vec3<Expr> c = cross(vec3(body.joint.axis), vec3(wheel.axle));
    return c.x.is_zero() && c.y.is_zero() && c.z.is_zero();
  };
  // The frame that carries the axle does not spin with the wheel: nothing then depends on the angle of the
  // spin.
  const bool carried =
      body.parent >= 0 && body.joint.kind == JointKind::revolute && parallel() && body.station.modes.empty();
  const Frame& frame = world_[static_cast<std::size_t>(carried ? body.parent : wheel.body)];
  const Mat3<Expr> R = carried ? Mat3<Expr>{body.R} : Mat3<Expr>::identity();
  const Vec3<Expr> centre = carried ? vec3(body.p) : Vec3<Expr>{};
  const Vec3<Expr> axle = R * vec3(wheel.axle);
  Vec3<Expr> w = frame.w;
  if (carried) w += rate(body.joint.displacement) * (R * vec3(body.joint.axis));

  Touch touch;
  const Vec3<Expr> world_normal = vec3(wheel.ground.normal);
  const Frame& seen_from_reference = internal_[static_cast<std::size_t>(carried ? body.parent : wheel.body)];
  touch.normal = transposed_times(wheel.upright ? seen_from_reference.R : frame.R, world_normal);
  Vec3<Expr> arm = -wheel.crown * touch.normal;  // from the centre to the point of contact
  if (!wheel.radius.is_zero()) {
    touch.along = cross(axle, touch.normal);
    const Expr sine = sqrt(dot(touch.along, touch.along));  // of the angle between axle and normal
    touch.along = (Expr(1) / sine) * touch.along;
    arm -=
        wheel.radius * cross(touch.along, axle);  // cross(along, axle): from the centre up, across the axle
  }
  touch.velocity = frame.v + cross(frame.w, centre) + cross(w, arm);
  const Vec3<Expr> up = transposed_times(frame.R, world_normal);
  touch.gap = dot(world_normal, frame.p) + dot(up, centre + arm) - wheel.ground.height;
  return touch;
}

namespace {

/// Three rows of a force along the axes of a frame, in which `normal` and `along` are unit vectors.
void add_force_rows(Contact& contact, const Vec3<Expr>& velocity, const Vec3<Expr>& normal,
                    const Vec3<Expr>& along) {
  const Vec3<Expr> lateral = cross(normal, along);
  for (int i = 0; i < 3; ++i)
    contact.rows.push_back(
        {axis_names[static_cast<std::size_t>(i)], velocity[i], {normal[i], along[i], lateral[i]}, true});
  contact.has_normal = true;
}

}  // namespace

Contact ContactGeometry::rolling(const Wheel& wheel) const {
  const Touch at = touch(wheel);
  Contact contact;
  add_force_rows(contact, at.velocity, at.normal, at.along);
  contact.has_directions = !wheel.radius.is_zero();
  contact.positions.push_back({"", at.gap, false});
  return contact;
}

Contact ContactGeometry::rolling(const Ellipsoid& ellipsoid) const {
  const Frame& frame = world_[static_cast<std::size_t>(ellipsoid.body)];
  const Vec3<Expr> world_normal = vec3(ellipsoid.ground.normal);
  const Vec3<Expr> normal = transposed_times(frame.R, world_normal);
  // The lowest point has its outward normal along -normal: x = -D normal / sqrt(normal . D normal), D =
  // diag(a_i^2).
  Vec3<Expr> scaled;
  for (int i = 0; i < 3; ++i) {
    const Expr& a = ellipsoid.semi_axes[static_cast<std::size_t>(i)];
    scaled[i] = a * a * normal[i];
  }
  const Expr support = sqrt(dot(normal, scaled));  // height of the centre above the plane
  const Vec3<Expr> point = vec3(ellipsoid.centre) - (Expr(1) / support) * scaled;
  const Vec3<Expr> velocity = frame.v + cross(frame.w, point);
  Contact contact;
  add_force_rows(contact, velocity, normal, {});
  contact.positions.push_back(
      {"",
       dot(world_normal, frame.p) + dot(normal, vec3(ellipsoid.centre)) - support - ellipsoid.ground.height,
       false});
  return contact;
}

Contact ContactGeometry::rollers(const Wheel& wheel, const Expr& angle) const {
  const Touch at = touch(wheel);
  const Vec3<Expr> lateral = cross(at.normal, at.along);
  Contact contact;
  const Expr c = cos(angle), s = sin(angle);
  contact.rows.push_back({"roller", dot(c * at.along + s * lateral, at.velocity), {0, c, s}, true});
  contact.rows.push_back({"normal", dot(at.normal, at.velocity), {1, 0, 0}, true});
  contact.has_normal = contact.has_directions = true;
  contact.positions.push_back({"", at.gap, false});
  return contact;
}

Contact ContactGeometry::attachment(const Attachment& a, FreeTurns turns, const std::array<Expr, 3>& axis,
                                    const std::array<Expr, 3>& other_axis) const {
  Contact contact;
  const Vec3<Expr> point = vec3(a.point);
  const std::array<Vec3<Expr>, 2> sides = across(vec3(a.other ? other_axis : axis));
  if (!a.other) {
    const Frame& frame = world_[static_cast<std::size_t>(a.body)];
    const Vec3<Expr> v = frame.v + cross(frame.w, point);
    const Vec3<Expr> normal = vec3(a.ground.normal);
    const Vec3<Expr> forward = cross(world_[0].R * unit<Expr>(1), normal);  // of the reference body, level
    add_force_rows(contact, v, transposed_times(frame.R, normal),
                   transposed_times(frame.R, (Expr(1) / sqrt(dot(forward, forward))) * forward));
    contact.has_directions = true;
    if (turns == FreeTurns::none) {
      for (int i = 0; i < 3; ++i)
        contact.rows.push_back(
            {std::string("turn_") + axis_names[static_cast<std::size_t>(i)], frame.w[i], {}, false});
    }
    if (turns == FreeTurns::about_axis) {
      for (std::size_t i = 0; i < 2; ++i)
        contact.rows.push_back({"turn_" + std::to_string(i + 1), dot(sides[i], frame.w), {}, false});
    }
    // The turns are kept by the places of further points, a metre away.
    std::vector<Vec3<Expr>> points = {point};
    if (turns == FreeTurns::about_axis) points.push_back(point + vec3(axis));
    if (turns == FreeTurns::none) {
      for (int i = 0; i < 3; ++i) points.push_back(point + unit<Expr>(i));
    }
    for (const Vec3<Expr>& x : points) {
      const Vec3<Expr> place = frame.p + frame.R * x;
      for (int i = 0; i < 3; ++i) contact.positions.push_back({"", place[i], true});
    }
    return contact;
  }
  const Frame& frame = internal_[static_cast<std::size_t>(a.body)];
  const Frame& other = internal_[static_cast<std::size_t>(*a.other)];
  const Vec3<Expr> gap = frame.p + frame.R * point - other.p - other.R * vec3(a.other_point);
  const auto keep = [&](const std::string& suffix, const Expr& condition, bool from_start) {
    contact.rows.push_back({suffix, rate(condition), {}, false});
    contact.positions.push_back({"", condition, from_start});
  };
  for (int i = 0; i < 3; ++i) keep(axis_names[static_cast<std::size_t>(i)], gap[i], false);
  if (turns == FreeTurns::about_axis) {  // the axis stays across two directions of the other body
    const Vec3<Expr> here = transposed_times(other.R, frame.R * vec3(axis));
    for (std::size_t i = 0; i < 2; ++i) keep("turn_" + std::to_string(i + 1), dot(sides[i], here), false);
  }
  if (turns == FreeTurns::none) {
    for (int i = 0; i < 3; ++i) {  // y of one stays across z of the other, and so on
      const Vec3<Expr> here = transposed_times(other.R, frame.R * unit<Expr>((i + 1) % 3));
      keep(std::string("turn_") + axis_names[static_cast<std::size_t>(i)], here[(i + 2) % 3], true);
    }
  }
  return contact;
}

Contact ContactGeometry::rod(const Attachment& a, const Expr& length) const {
  const Frame& frame = internal_[static_cast<std::size_t>(a.body)];
  const Frame& other = internal_[static_cast<std::size_t>(*a.other)];
  const Vec3<Expr> d = frame.p + frame.R * vec3(a.point) - other.p - other.R * vec3(a.other_point);
  const Expr condition = (dot(d, d) - length * length) / (Expr(2) * length);
  Contact contact;
  contact.rows.push_back({"length", rate(condition), {}, false});
  contact.positions.push_back({"", condition, false});
  return contact;
}

}  // namespace anholon
