// SPDX-License-Identifier: MIT
#pragma once

// A mechanism over any scalar: the plain data that the recursion works on. Every joint moves about or along a
// coordinate axis of its own frame; what a description says about other axes is folded into the constant
// poses.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anholon/added_mass.hpp"
#include "anholon/lie/group_kind.hpp"
#include "anholon/spatial.hpp"

namespace anholon {

enum class JointKind { fixed, revolute, prismatic, helical };

/// Position and velocity of a mechanism. r and r_dot hold every independent internal coordinate, in declared
/// order.
template <class S>
struct State {
  Mat3<S> R = Mat3<S>::identity();  // orientation of the reference body in the world
  Vec3<S> p;                        // position of the reference body in the world, m
  std::vector<S> r, r_dot;
  Spatial<S> eta;  // (V, Omega) of the reference body in its own axes; zero where the group has none
  S t = S(0);      // s
};

/// Mode j of a compliant body, whose points p are polynomials of second order in the modal coordinates at
/// most; integrals over the body in its own axes. How far the kinetic energy follows the deformation is a
/// matter of the last two entries alone.
template <class S>
struct Mode {
  int coordinate = 0;
  Vec3<S> S_j;                // integral of dp/dr_j dm, undeformed
  Mat3<S> N_j;                // integral of p (dp/dr_j)^T dm, undeformed
  std::vector<S> m_jl;        // integral of dp/dr_j . dp/dr_l dm, undeformed, for every mode l of the body
  std::vector<Vec3<S>> S_jl;  // derivative of S_j by r_l, symmetric in j and l
  std::vector<Mat3<S>> N_jl;  // derivative of N_j by r_l
};

/// What mode j of a compliant body does at a place where another body hangs on it.
template <class S>
struct StationMode {
  int coordinate = 0;
  Vec3<S> phi;               // displacement per r_j
  Vec3<S> turn;              // rotation vector per r_j
  std::vector<Vec3<S>> psi;  // second derivative of the place by r_j and r_l, for every mode l
};

/// A place on a compliant body: there the frame is at + sum phi_j r_j + 1/2 sum psi_jl r_j r_l, turned by exp
/// of the rotation vector sum turn_j r_j; all in the axes of the compliant body.
template <class S>
struct Station {
  int axis = -1;  // of all turns, where they share a coordinate axis; else -1
  Vec3<S> at;
  std::vector<StationMode<S>> modes;  // empty: the body hangs on a rigid one
};

template <class S>
struct Body {
  std::string name;
  int parent = -1;
  JointKind kind = JointKind::fixed;
  int axis = 2;                     // of the joint, in the body's frame
  S pitch = S(0);                   // helical: translation per angle, m/rad
  S armature = S(0);                // inertia of what turns or slides with the joint's rate, kg m^2 or kg
  int coordinate = -1;              // independent coordinate that moves the joint alone, or -1
  int coupling = -1;                // index into Mechanism::couplings, or -1
  Mat3<S> R = Mat3<S>::identity();  // pose in the frame of parent or station, at zero displacement
  Vec3<S> p;
  Mat3<S> R_frame =
      Mat3<S>::identity();  // the described frame, in the body's: same origin, constant rotation
  S mass = S(0);
  Vec3<S> first_moment;               // integral of X dm about the origin
  Mat3<S> inertia;                    // about the origin
  std::vector<Mode<S>> modes;         // empty: rigid
  std::optional<AddedMass<S>> fluid;  // of the fluid that moves with the body's frame
  Station<S> station;                 // on the parent; the pose is in its frame
};

/// Displacement of a coupled joint, with its derivatives by the independent coordinates that it depends on.
template <class S>
struct Coupling {
  std::vector<int> on;  // coordinates
  /// writes (c, dc/dr_on[0], ..., d2c/dr_on[0]dr_on[0], d2c/dr_on[0]dr_on[1], ...) row-major
  std::function<void(std::span<const S> r, std::span<S> out)> evaluate;
};

/// linear . (velocity of a point fixed in the body) + angular . (angular velocity), in the body's frame.
template <class S>
struct RowTerm {
  int body = 0;
  Vec3<S> point, linear, angular;
};

/// One row of eq. (2): the sum of its terms and of written coefficients.
template <class S>
struct ConstraintRow {
  std::string name;
  std::vector<RowTerm<S>> terms;
  /// writes the 6 + s coefficients of (eta, r_dot) and then the bias (d coefficients / dt) . velocities
  std::function<void(const State<S>&, std::span<S> out)> written;
};

/// A wrench on a body, at a point of it.
template <class S>
struct AppliedWrench {
  int body = 0;
  bool in_world_axes = false;
  bool dissipates = false;             // its power is lost, and is counted as that
  Vec3<S> point;                       // in the body's frame
  Mat3<S> axes = Mat3<S>::identity();  // of the wrench, in the body's frame; not used in world axes
  /// writes (force, torque) in the wrench's axes, 6 numbers
  /// @param velocity  of the point, and angular velocity of the body, in the same axes
  std::function<void(const State<S>&, const Spatial<S>& velocity, std::span<S> out)> evaluate;
};

template <class S>
struct Mechanism {
  GroupKind group = GroupKind::fixed;
  int coordinates = 0;  // s: independent internal coordinates
  std::vector<Body<S>> bodies;
  std::vector<Coupling<S>> couplings;
  std::vector<ConstraintRow<S>> rows;
  int conditions = 0;  // on the position, whose derivatives are combinations of the rows
  /// writes, for each condition, its value and its derivatives by the 6 + s velocities
  std::function<void(const State<S>&, std::span<S> out)> position_conditions;
  Vec3<S> gravity;  // acceleration, world axes, m/s^2

  std::vector<AppliedWrench<S>> wrenches;
  /// writes the 6 + s generalised forces of potential, dissipation and the user's own; empty where there are
  /// none
  std::function<void(const State<S>&, std::span<S> out)> generalised_forces;
  /// writes (potential energy without gravity, dissipated power, power of the user's generalised forces)
  std::function<void(const State<S>&, std::span<S> out)> user_energies;
  /// opens a named section of a derived program; empty for numbers
  std::function<void(const std::string&)> open_section;

  void section(const std::string& title) const {
    if (open_section) open_section(title);
  }
};

}  // namespace anholon
