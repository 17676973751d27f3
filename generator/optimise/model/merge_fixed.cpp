// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/model/merge_fixed.hpp"

#include <vector>

#include "optimise/model/constants.hpp"

namespace anholon {
namespace {

/// Where an old body went: the new body that holds it, and its frame in that one's.
template <class S>
struct Place {
  int index = 0;
  Mat3<S> R = Mat3<S>::identity();
  Vec3<S> p;
  bool moved = false;
};

template <class S>
void move_rows(Mechanism<S>& mechanism, const std::vector<Place<S>>& places) {
  for (ConstraintRow<S>& row : mechanism.rows) {
    for (RowTerm<S>& term : row.terms) {
      const Place<S>& place = places[static_cast<std::size_t>(term.body)];
      term.body = place.index;
      if (!place.moved) continue;
      term.point = place.p + place.R * term.point;
      term.linear = place.R * term.linear;
      term.angular = place.R * term.angular;
    }
  }
}

template <class S>
void move_wrenches(Mechanism<S>& mechanism, const std::vector<Place<S>>& places) {
  for (AppliedWrench<S>& wrench : mechanism.wrenches) {
    const Place<S>& place = places[static_cast<std::size_t>(wrench.body)];
    wrench.body = place.index;
    if (!place.moved) continue;
    wrench.point = place.p + place.R * wrench.point;
    wrench.axes = place.R * wrench.axes;
  }
}

}  // namespace

template <class S>
int merge_fixed(Mechanism<S>& mechanism) {
  std::vector<Body<S>>& bodies = mechanism.bodies;
  std::vector<Body<S>> kept;
  std::vector<Place<S>> places(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    Body<S> body = bodies[k];
    Place<S>& place = places[k];
    if (body.parent >= 0) {
      const Place<S>& parent = places[static_cast<std::size_t>(body.parent)];
      if (parent.moved) {
        body.p = parent.p + parent.R * body.p;
        body.R = parent.R * body.R;
      }
      body.parent = parent.index;
    }
    const bool merges = body.parent >= 0 && body.kind == JointKind::fixed && body.modes.empty() &&
                        kept[static_cast<std::size_t>(body.parent)].modes.empty();
    if (!merges) {
      place.index = static_cast<int>(kept.size());
      kept.push_back(std::move(body));
      continue;
    }
    place = {body.parent, body.R, body.p, true};
    Body<S>& into = kept[static_cast<std::size_t>(body.parent)];
    set_moments(into, moments_of(into) + moments_in(body.R, body.p, moments_of(body)));
    if (!body.fluid) continue;
    const AddedMass<S> moved = body.fluid->turned_by(body.R).moved(body.p);
    into.fluid = into.fluid ? *into.fluid + moved : moved;
  }
  const int gone = static_cast<int>(bodies.size() - kept.size());
  bodies = std::move(kept);
  move_rows(mechanism, places);
  move_wrenches(mechanism, places);
  return gone;
}

template int merge_fixed(Mechanism<Exact>&);
template int merge_fixed(Mechanism<Expr>&);

}  // namespace anholon
