// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Rows of eq. (2) of declared contacts and loops, written on the model's own tape: a contact is where two
// things touch and which relative velocities that forbids. Rows that are the derivative of a condition on the
// position carry it, so that a simulation can keep it.

#include <optional>
#include <string>
#include <vector>

#include "describe/model.hpp"

namespace anholon {

/// One row of a contact.
struct ContactRow {
  std::string suffix;                     // of the row's name: "x", "turn_y", ...
  Expr row = 0;                           // linear in the velocities, vanishes where the contact holds
  std::array<Expr, 3> share = {0, 0, 0};  // of its multiplier in the force (normal, longitudinal, lateral)
  bool is_force = true;                   // else a moment
};

struct Contact {
  std::vector<ContactRow> rows;
  std::vector<PositionDescription> positions;
  bool has_normal = false;      // a ground that pushes
  bool has_directions = false;  // longitudinal and lateral ones
};

/// A plane that stands still in the world.
struct Ground {
  std::array<Expr, 3> normal = {0, 0, 1};  // unit vector, world axes
  Expr height = 0;                         // of the plane along the normal, m
};

/// A wheel that rolls without slip: a rim of radius `radius` about the axle, whose cross-section is a circle
/// of radius `crown` (0: a thin disc; radius 0: a sphere).
struct Wheel {
  int body = 0;
  std::array<Expr, 3> axle = {0, 1, 0};  // unit vector, wheel frame
  Expr radius = 0, crown = 0;            // m
  Ground ground;
  bool upright = false;  // the reference body stays parallel to the ground
};

/// An ellipsoid that rolls without slip; equal semi-axes are a ball.
struct Ellipsoid {
  int body = 0;
  std::array<Expr, 3> centre = {0, 0, 0};     // body frame, m
  std::array<Expr, 3> semi_axes = {0, 0, 0};  // along the axes of the body, m
  Ground ground;
};

/// Where a body holds on: to the world, or to a point of another body.
struct Attachment {
  int body = 0;
  std::array<Expr, 3> point = {0, 0, 0};  // body frame, m
  std::optional<int> other;
  std::array<Expr, 3> other_point = {0, 0, 0};  // frame of the other body, m
  Ground ground;                                // that a foot stands on; says what is normal
};

/// Turns that an attachment leaves free.
enum class FreeTurns { all, about_axis, none };

/// Poses and twists of the bodies of a model as expressions of its state, in the described frames.
class ContactGeometry {
 public:
  /// Needs every body of the model; adds nodes to its tape.
  explicit ContactGeometry(const Model& model);

  /// Three rows: the material velocity at the point of contact, in axes of the frame that carries the axle
  /// (of the wheel itself where it is the reference body), so that a kernel basis is regular at every heading
  /// and lean. The condition of touching goes with it: the point of contact lies in the plane. Of an upright
  /// wheel the rows do not depend on the pose: a car on four wheels then has, wherever it is evaluated, the
  /// ranks that it has on the ground.
  [[nodiscard]] Contact rolling(const Wheel& wheel) const;
  /// Likewise for an ellipsoid, in axes of its body.
  [[nodiscard]] Contact rolling(const Ellipsoid& ellipsoid) const;
  /// A wheel with rollers on its rim, whose axes are turned by `angle` from the direction of rolling (0: omni
  /// wheel,
  /// +-pi/4: mecanum wheel): one row, the velocity at the point of contact along the roller's axis; in space
  /// also the row that keeps the wheel on the ground.
  [[nodiscard]] Contact rollers(const Wheel& wheel, const Expr& angle) const;
  /// A point of a body keeps its place; with fewer free turns also its orientation. Rows in axes of the body
  /// (to the world) or of the reference body (to another body).
  /// @param axis  of the free turn, body frame; other_axis the same in the frame of the other body
  [[nodiscard]] Contact attachment(const Attachment& a, FreeTurns turns, const std::array<Expr, 3>& axis,
                                   const std::array<Expr, 3>& other_axis) const;
  /// Two points keep their distance. One row.
  [[nodiscard]] Contact rod(const Attachment& a, const Expr& length) const;

 private:
  struct Frame {
    Mat3<Expr> R;     // orientation in the world
    Vec3<Expr> p;     // origin in the world, m
    Vec3<Expr> v, w;  // twist in its own axes
  };
  struct Touch {               // in the frame that carries the axle
    Vec3<Expr> velocity;       // of the wheel's material at the point of contact
    Vec3<Expr> normal, along;  // of the ground; of rolling, unit vectors
    Expr gap;                  // of the point of contact above the plane, m
  };
  [[nodiscard]] Touch touch(const Wheel& wheel) const;
  [[nodiscard]] Expr rate(const Expr& of_shape) const;  // d/dt of a function of the coordinates

  const Model& model_;
  std::vector<Frame> world_;     // of the bodies, reference body moving
  std::vector<Frame> internal_;  // of the bodies in the frame of the reference body, twists left out
};

}  // namespace anholon
