// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/model/regroup.hpp"

#include "optimise/model/constants.hpp"

namespace anholon {

template <class S>
void regroup(Mechanism<S>& mechanism, std::size_t k) {
  Body<S>& body = mechanism.bodies[k];
  Body<S>& parent = mechanism.bodies[static_cast<std::size_t>(body.parent)];
  MassMoments<S> own = moments_of(body);
  MassMoments<S> given;
  const int n = body.axis;
  if (body.kind == JointKind::revolute) {
    given.mass = own.mass;
    given.first[n] = own.first[n];
    given.second.diagonal[n] = own.second.diagonal[n];
    own.mass = own.first[n] = own.second.diagonal[n] = S(0);
    set_moments(parent, moments_of(parent) + moments_in(body.R, body.p, given));
  } else if (body.kind == JointKind::prismatic) {
    given.second = own.second;
    own.second = {};
    set_moments(parent, moments_of(parent) + moments_in(body.R, Vec3<S>{}, given));
  } else {
    return;
  }
  set_moments(body, own);
}

template <class S>
void regroup(Mechanism<S>& mechanism) {
  require_rigid_tree(mechanism);
  for (std::size_t k = mechanism.bodies.size(); k-- > 1;) regroup(mechanism, k);
}

template void regroup(Mechanism<Exact>&, std::size_t);
template void regroup(Mechanism<Expr>&, std::size_t);
template void regroup(Mechanism<Exact>&);
template void regroup(Mechanism<Expr>&);

}  // namespace anholon
