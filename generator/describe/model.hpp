// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What a robot is, after reading: every number is an expression on the model's own tape, whose inputs are the
// parameters and the state. Nothing here knows how the robot is solved.

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "anholon/lie/group_kind.hpp"
#include "anholon/mechanism.hpp"
#include "describe/location.hpp"
#include "describe/repetition.hpp"
#include "tape/expr.hpp"

namespace anholon {

struct Parameter {
  std::string name;
  Exact value;
  std::string unit;  // as written: "kg m^2"; coherent SI
  std::string meaning;
  Location where;
};

enum class Drive { active, passive };  // active: motion imposed, or torque imposed where a program says so

/// An independent internal coordinate r_i: of a joint or of a mode.
struct Coordinate {
  std::string name;
  Drive drive = Drive::passive;
  bool is_angle = false;  // unit rad, else m
  Exact lower = -3;       // working range [lower, upper]; a revolute joint's default is [-pi, pi]
  Exact upper = 3;
  Location where;
};

/// A joint: its body's frame is pose * motion(displacement) in the parent's frame.
struct JointDescription {
  JointKind kind = JointKind::fixed;
  std::array<Expr, 3> axis = {0, 0, 1};  // unit vector, in the body's frame
  Expr pitch = 0;                        // of a helical joint, m/rad
  Expr armature = 0;       // inertia of the motor, times the squared ratio of its gear, kg m^2 or kg
  Expr displacement = 0;   // an independent coordinate, or an expression of several (a coupling)
  std::string coordinate;  // name as written; empty for a fixed joint
};

/// How far the kinetic energy T of a compliant body follows its deformation.
enum class Deformation {
  linear,     // no terms of second order in the modal coordinates
  quadratic,  // all terms of the displacement field that is linear in them
  stiffened   // also those of the foreshortening, up to the second order
};

/// Mode j of a compliant body: p = X + sum_j phi_j r_ej + 1/2 sum_jl psi_jl r_ej r_el, all in the body's
/// frame. psi is the foreshortening; empty where it is not known.
struct ModeDescription {
  int coordinate = 0;                        // index of r_ej in Model::coordinates
  int family = 0;                            // modes of a kind: a plane of bending, torsion, axial
  std::array<Expr, 3> S;                     // integral of phi_j dm
  std::array<Expr, 9> X_phi;                 // integral of X phi_j^T dm, row-major
  std::vector<std::array<Expr, 9>> phi_phi;  // integral of phi_j phi_l^T dm for each mode l of this body
  std::vector<std::array<Expr, 3>> psi;      // integral of psi_jl dm
  std::vector<std::array<Expr, 9>> X_psi;    // integral of X psi_jl^T dm
};

/// A place on a compliant body, in its frame, with what each of its modes does there.
struct StationDescription {
  struct Mode {
    int coordinate = 0;
    std::array<Expr, 3> phi = {0, 0, 0};
    std::array<Expr, 3> turn = {0, 0, 0};  // rotation vector per r_ej
    std::vector<std::array<Expr, 3>> psi;  // empty where the foreshortening is not known
  };
  std::array<Expr, 3> at = {0, 0, 0};
  std::vector<Mode> modes;
};

struct BodyDescription {
  std::string name;
  int parent = -1;                                      // -1: the reference body
  StationDescription station;                           // where the parent is compliant
  std::array<Expr, 9> R = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // pose in the frame of parent or station
  std::array<Expr, 3> p = {0, 0, 0};
  JointDescription joint;
  Expr mass = 0;
  std::array<Expr, 3> first_moment = {0, 0, 0};      // about the body's origin
  std::array<Expr, 6> inertia = {0, 0, 0, 0, 0, 0};  // xx yy zz xy xz yz about the origin, matrix entries
  std::vector<ModeDescription> modes;                // empty: rigid
  std::optional<AddedMass<Expr>> fluid;              // about the body's origin, in its axes
  Deformation deformation = Deformation::stiffened;
  Location where;
};

/// One term of a declared row: linear . (velocity of a point fixed in the body) + angular . (angular
/// velocity), all in the body's own axes.
struct RowTermDescription {
  int body = 0;
  std::array<Expr, 3> point = {0, 0, 0};
  std::array<Expr, 3> linear = {0, 0, 0};
  std::array<Expr, 3> angular = {0, 0, 0};
};

/// A constraint row: declared (terms) or written by the user (an expression, linear in the velocities).
struct RowDescription {
  std::string name;
  std::string contact;  // the [[constraint]] that it is part of
  std::vector<RowTermDescription> terms;
  std::optional<Expr> expression;
  Location where;
};

/// A condition on the position, whose derivative is a combination of the rows of its contact.
struct PositionDescription {
  std::string contact;
  Expr value = 0;           // m or 1
  bool from_start = false;  // keeps the value that it has where the contact begins; else zero
};

/// What a contact with the ground carries, in physical terms.
struct ContactForceDescription {
  /// Of the multiplier of one row in the force.
  struct Share {
    std::string row;
    Expr normal = 0;  // away from the ground
    Expr longitudinal = 0, lateral = 0;
  };
  std::string contact;
  std::vector<Share> shares;     // of the rows that are forces, not moments
  bool has_normal = true;        // a plane model has none
  bool has_directions = true;    // longitudinal and lateral; else the rows are orthonormal components
  std::optional<Expr> friction;  // coefficient, 1
  bool unilateral = true;        // the ground only pushes
};

/// External wrench on a body: expressions of state, parameters, time and the velocity of the body there.
struct WrenchDescription {
  int body = 0;
  bool dissipates = false;                // its power is lost
  bool in_world_axes = false;             // else in the body's axes
  std::array<Expr, 3> point = {0, 0, 0};  // application point, body frame
  std::array<Expr, 3> force = {0, 0, 0};
  std::array<Expr, 3> torque = {0, 0, 0};
};

struct GeneralisedForceDescription {
  int index = 0;  // 0..5: component of the base wrench in body axes; 6 + i: coordinate i
  Expr force = 0;
  bool dissipates = false;  // its power is lost
};

/// The state that expressions may name, as inputs of the model's tape.
struct StateSymbols {
  std::vector<NodeId> parameters;  // in the order of Model::parameters
  NodeId t = 0;
  std::array<NodeId, 9> R{};    // orientation of the reference body in the world, row-major
  std::array<NodeId, 3> p{};    // position of the reference body in the world
  std::vector<NodeId> r;        // in the order of Model::coordinates
  std::array<NodeId, 6> eta{};  // V, Omega in body axes
  std::vector<NodeId> r_dot;
  std::vector<NodeId> local;  // of the wrench that is evaluated: velocity of its point, angular velocity of
                              // its body, in its axes; empty where no wrench uses them
};

struct Model {
  std::string name;
  std::string title;   // one line, for reports
  std::string file;    // base name of the description
  std::string sha256;  // of its bytes
  GroupKind group = GroupKind::fixed;
  std::shared_ptr<Tape> tape = std::make_shared<Tape>();
  StateSymbols symbols;
  std::vector<Parameter> parameters;
  std::vector<Coordinate> coordinates;
  std::vector<BodyDescription> bodies;  // [0] is the reference body; parents precede children
  std::vector<RowDescription> rows;
  std::vector<PositionDescription> positions;
  std::vector<WrenchDescription> wrenches;
  std::vector<GeneralisedForceDescription> forces;
  std::array<Expr, 3> gravity = {0, 0, 0};   // acceleration of gravity in the world
  Expr potential = 0;                        // joint springs, modal stiffness and the user's; without gravity
  Expr dissipation = 0;                      // Rayleigh function of the velocities, eq. (21)
  std::vector<std::string> free_velocities;  // user's choice of kernel coordinates; may be empty
  std::vector<std::string> notes;            // what reading assumed, for `check`
  std::vector<Count> counts;                 // how often parts of the description come
  std::vector<ContactForceDescription> contact_forces;
  std::size_t deflections = 0;  // of elastic contacts: the last coordinates
};

}  // namespace anholon
