// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/model/rotate_leaves.hpp"

#include "optimise/model/constants.hpp"

namespace anholon {

template <class S>
void turn_frame(Mechanism<S>& mechanism, std::size_t k, const S& angle, const S& c, const S& s) {
  Body<S>& body = mechanism.bodies[k];
  const Mat3<S> back = AxisRotation<S>{body.axis, c, -s}.matrix();
  set_moments(body, moments_in(back, Vec3<S>{}, moments_of(body)));
  body.R_frame = back * body.R_frame;
  for (Body<S>& child : mechanism.bodies) {
    if (child.parent != static_cast<int>(k)) continue;
    child.R = back * child.R;
    child.p = back * child.p;
  }
  Coupling<S> shifted;
  if (body.coupling >= 0) {
    shifted = mechanism.couplings[static_cast<std::size_t>(body.coupling)];
    shifted.evaluate = [angle, before = shifted.evaluate](std::span<const S> r, std::span<S> out) {
      before(r, out);
      out[0] = out[0] + angle;
    };
  } else {
    shifted.on = {body.coordinate};
    shifted.evaluate = [angle, at = static_cast<std::size_t>(body.coordinate)](std::span<const S> r,
                                                                               std::span<S> out) {
      out[0] = r[at] + angle;
      out[1] = S(1);
      out[2] = S(0);
    };
  }
  body.coordinate = -1;
  body.coupling = static_cast<int>(mechanism.couplings.size());
  mechanism.couplings.push_back(std::move(shifted));
}

namespace {

template <class S>
struct Turn {
  S angle, c, s;
};

/// The angle of (x, y), which are not both zero by structure. Where they depend on parameters, its sine and
/// cosine are taken of the angle, so that parameters that make both vanish do no harm.
template <class S>
Turn<S> turn_onto(const S& x, const S& y) {
  const auto x_value = constant_value(x);
  const auto y_value = constant_value(y);
  if (!x_value || !y_value) {
    if constexpr (std::is_same_v<S, Expr>) {
      const S angle = atan2(y, x);
      return {angle, cos(angle), sin(angle)};
    }
    throw std::logic_error("a number without a value");
  }
  const Exact length = sqrt(*x_value * *x_value + *y_value * *y_value);
  return {constant_like(x, atan2(*y_value, *x_value)), constant_like(x, *x_value / length),
          constant_like(x, *y_value / length)};
}

}  // namespace

template <class S>
int rotate_leaves(Mechanism<S>& mechanism) {
  require_rigid_tree(mechanism);
  int turned_frames = 0;
  for (std::size_t k = 1; k < mechanism.bodies.size(); ++k) {
    const Body<S>& body = mechanism.bodies[k];
    if (body.kind != JointKind::revolute) continue;
    bool is_tip = true;
    for (const Body<S>& other : mechanism.bodies) is_tip = is_tip && other.parent != static_cast<int>(k);
    const S& along_x = body.first_moment[(body.axis + 1) % 3];
    const S& along_y = body.first_moment[(body.axis + 2) % 3];
    if (!is_tip || vanishes(along_x) || vanishes(along_y)) continue;
    const Turn<S> turn = turn_onto(along_x, along_y);
    turn_frame(mechanism, k, turn.angle, turn.c, turn.s);
    mechanism.bodies[k].first_moment[(body.axis + 2) % 3] = S(0);  // up to rounding
    ++turned_frames;
  }
  return turned_frames;
}

template void turn_frame(Mechanism<Exact>&, std::size_t, const Exact&, const Exact&, const Exact&);
template void turn_frame(Mechanism<Expr>&, std::size_t, const Expr&, const Expr&, const Expr&);
template int rotate_leaves(Mechanism<Exact>&);
template int rotate_leaves(Mechanism<Expr>&);

}  // namespace anholon
