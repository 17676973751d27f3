// SPDX-License-Identifier: GPL-2.0-or-later
#include "optimise/model/merge_fixed.hpp"

#include "optimise/model/constants.hpp"

namespace anholon {

template <class S>
int merge_fixed(Mechanism<S>& mechanism) {
  require_rigid_tree(mechanism);
  std::vector<Body<S>>& bodies = mechanism.bodies;
  std::vector<int> index(bodies.size(), 0);  // new index of each body; that of what took it in
  std::vector<Body<S>> kept;
  struct Pose {
    Mat3<S> R = Mat3<S>::identity();
    Vec3<S> p;
  };
  std::vector<Pose> in_new(bodies.size());  // of the old body's frame in the frame of what took it in
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    Body<S> body = bodies[k];
    if (body.parent >= 0) {
      const auto parent = static_cast<std::size_t>(body.parent);
      const Pose& of_parent = in_new[parent];
      body.p = of_parent.p + of_parent.R * body.p;
      body.R = of_parent.R * body.R;
      body.parent = index[parent];
    }
    if (body.parent < 0 || body.kind != JointKind::fixed) {
      index[k] = static_cast<int>(kept.size());
      kept.push_back(std::move(body));
      continue;
    }
    index[k] = body.parent;
    in_new[k] = {body.R, body.p};
    Body<S>& into = kept[static_cast<std::size_t>(body.parent)];
    set_moments(into, moments_of(into) + moments_in(body.R, body.p, moments_of(body)));
  }
  const int gone = static_cast<int>(bodies.size() - kept.size());
  bodies = std::move(kept);
  return gone;
}

template int merge_fixed(Mechanism<Exact>&);
template int merge_fixed(Mechanism<Expr>&);

}  // namespace anholon
