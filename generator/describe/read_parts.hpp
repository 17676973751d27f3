// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The parts of a description, one function and one file each. All of them fill Reading::model and report
// errors to Reading::findings.

#include "describe/outline.hpp"

namespace anholon {

struct PoseDescription {
  std::array<Expr, 9> R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<Expr, 3> p = {0, 0, 0};
};

/// { translation, rotation }
PoseDescription read_pose(const Value& pose, const std::string& what, Reading& reading);

/// Pose of a body in its parent's frame.
void read_pose(BodyOutline& body, BodyDescription& described, Reading& reading);

/// Axis, range, drive, armature, spring, damper and friction of a body's joint.
void read_joint(BodyOutline& body, BodyDescription& described, Reading& reading);

/// Drive, range, armature, spring, damper and friction alone: what a robot file does not say of its joints.
/// @param coordinate  index of the coordinate that moves the joint; -1 where the joint follows others
void read_joint_supplement(TableReader& joint, BodyDescription& described, int coordinate, Reading& reading);

/// Mass, first moment and inertia, brought to the body's origin.
void read_inertia(BodyOutline& body, BodyDescription& described, Reading& reading);

/// Station of a body on a compliant parent.
/// @param parent  null for a rigid parent
void read_station(BodyOutline& body, BodyDescription& described, const BodyOutline* parent, Reading& reading);

/// Modes by a table of invariants.
void read_modal_body(BodyOutline& body, BodyDescription& described, Reading& reading);

/// A beam and its modes.
void read_beam(BodyOutline& body, BodyDescription& described, Reading& reading);

/// A body named by a value, or by the value of a key; empty after an error.
std::optional<int> read_body_name(TableReader& table, const Value& value, Reading& reading);
std::optional<int> read_body(TableReader& table, std::string_view key, Reading& reading);

enum class ContactKind { wheel, ellipsoid, rollers, point, line, surface, loop };

/// Rows of a contact or loop, named after `name`; its conditions on the position go to the model. Empty after
/// an error.
std::vector<RowDescription> read_contact(TableReader& table, ContactKind kind, const std::string& name,
                                         Reading& reading);

/// Constraint rows: written ones, those declared in the plane, and those of contacts.
void read_constraints(TableReader& root, Reading& reading);

/// Wrenches and generalised forces.
void read_forces(TableReader& root, Reading& reading);

/// What a fluid does to bodies and beams. Sections of beams become bodies, the last ones of the model.
/// @param first_outlined  index in Model::bodies of the outline's first body
void read_fluids(TableReader& root, const Outline& outline, int first_outlined, Reading& reading);

/// Velocity of the point that a wrench acts on, and angular velocity of its body, in the axes of the wrench:
/// inputs of the model's tape that have these values while that wrench is evaluated.
std::array<Expr, 6> local_velocity(Reading& reading);

/// A function of x alone, as the user writes it: value and two derivatives. Empty after an error.
std::optional<std::function<std::array<Exact, 3>(const Exact& x)>> read_function_of_x(const Value& value,
                                                                                      const std::string& what,
                                                                                      Reading& reading);

/// Acceleration of gravity.
void read_gravity(TableReader& root, Reading& reading);

/// Potential and dissipation, added to what joints and beams have.
void read_energies(TableReader& root, Reading& reading);

/// Velocities that the user wants as coordinates of the kernel.
void read_free_velocities(TableReader& root, Reading& reading);

/// Names of the groups, in the order of GroupKind.
std::vector<std::string> group_names();

/// Adds the generalised force `force` that works on `displacement`: on each independent coordinate its share.
/// @param dissipates  whether its power counts as lost
void add_force_on(const Expr& displacement, const Expr& force, Reading& reading, bool dissipates = false);

/// Tables of an array of tables, such as [[body]]; anything else in it is an error.
std::vector<const Value*> tables_of(TableReader& root, std::string_view key, Findings& findings);

}  // namespace anholon
