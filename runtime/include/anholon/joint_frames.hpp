// SPDX-License-Identifier: MIT
#pragma once

// The joint frame of a body: its origin is the body's, its axes do not turn with the joint. A revolute joint
// that is parallel to its parent's keeps the axes of the parent's joint frame and turns by the sum of both
// angles; what is given in joint frames passes between parallel joints (hip, knee and ankle of a leg) without
// a turn.

#include <vector>

#include "anholon/rigid_tree.hpp"

namespace anholon {

template <class S>
class JointFrames {
 public:
  /// Needs position(). Sines and cosines of sums of angles are taken of the sums.
  explicit JointFrames(const RigidTree<S>& tree) : tree_(tree), joints_(tree.size()) {
    using std::cos, std::sin;
    tree.mechanism().section("joint angles");
    for (std::size_t k = 1; k < tree.size(); ++k) {
      const JointTransform<S>& joint = tree.joint(k);
      const Frame& parent = joints_[tree.parent_of(k)];
      Frame& frame = joints_[k];
      frame = {false, joint.displacement, joint.rotation, joint.offset};
      if (!shares_axes(k)) continue;
      frame.parallel = true;
      frame.angle = parent.angle + joint.displacement;
      frame.turn.c = cos(frame.angle);
      frame.turn.s = sin(frame.angle);
      frame.offset = parent.turn.apply(joint.offset);
    }
  }

  [[nodiscard]] bool is_parallel(std::size_t k) const { return joints_[k].parallel; }
  /// From the body's axes to those of its joint frame.
  [[nodiscard]] const AxisRotation<S>& turn(std::size_t k) const { return joints_[k].turn; }
  /// Of the body's origin, in the parent's joint frame where the joints are parallel, else in the parent's
  /// body.
  [[nodiscard]] const Vec3<S>& offset(std::size_t k) const { return joints_[k].offset; }

  /// A wrench about body k's origin in its joint frame as one about the parent's, in the parent's joint
  /// frame; the reference body has none but its own axes.
  [[nodiscard]] Spatial<S> to_parent(std::size_t k, Spatial<S> f) const {
    const std::size_t parent = tree_.parent_of(k);
    if (!is_parallel(k)) {
      const Mat3<S>& R = tree_.body(k).R;
      f = {R * f.linear, R * f.angular};
    }
    f.angular += cross(offset(k), f.linear);
    if (is_parallel(k) || parent == 0) return f;
    return {turn(parent).apply(f.linear), turn(parent).apply(f.angular)};
  }

 private:
  struct Frame {
    bool parallel = false;
    S angle = S(0);
    AxisRotation<S> turn;
    Vec3<S> offset;
  };

  /// Whether body k is fixed to axes parallel to its parent's but for turns about one common axis.
  [[nodiscard]] bool shares_axes(std::size_t k) const {
    const std::size_t j = tree_.parent_of(k);
    const Body<S>& b = tree_.body(k);
    const Body<S>& parent = tree_.body(j);
    if (j == 0 || b.kind != JointKind::revolute || parent.kind != JointKind::revolute) return false;
    if (b.axis != parent.axis) return false;
    const Mat3<S> one = Mat3<S>::identity();
    for (std::size_t i = 0; i < one.m.size(); ++i) {
      if (!vanishes(b.R.m[i] - one.m[i])) return false;
    }
    return true;
  }

  const RigidTree<S>& tree_;
  std::vector<Frame> joints_;
};

}  // namespace anholon
