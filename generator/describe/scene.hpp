// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A scene: what is wanted from a model. Which outputs, which parameters are frozen, joints locked and modes
// kept, whether there is gravity, how the active coordinates move, and how to integrate. docs/model-file.md
// documents every key.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "describe/model.hpp"

namespace anholon {

/// A coordinate that the scene holds at a value: an expression of parameters on the model's tape.
struct LockedCoordinate {
  int coordinate = 0;
  Expr value = 0;
};

/// Imposed motion of an active coordinate: expressions of parameters and t on the model's tape, exact
/// derivatives.
struct ImposedMotion {
  int coordinate = 0;
  Expr r = 0, r_dot = 0, r_ddot = 0;
};

/// Torque on a torque-driven coordinate: an expression of parameters, state and t on the model's tape.
struct ImposedTorque {
  int coordinate = 0;
  Expr torque = 0;
};

/// Imposed motion through the rows of a table.
struct MotionTable {
  enum class Ends { natural, clamped, periodic };
  std::filesystem::path file;
  Ends ends = Ends::natural;              // clamped: at rest at both ends
  std::vector<int> coordinates;           // of the columns behind the first, which is t
  std::vector<double> times;              // strictly increasing
  std::vector<std::vector<double>> rows;  // one value a coordinate
};

/// Where a motion starts. What is not named is zero, but velocities: those follow from the rows as far as
/// these rule them.
struct InitialState {
  std::array<Exact, 9> R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  std::array<Exact, 3> p = {0, 0, 0};
  std::vector<std::pair<int, Exact>> coordinates;  // index in Model::coordinates
  std::vector<std::pair<int, Exact>> velocities;   // 0..5: component of eta; 6 + i: rate of coordinate i
  std::vector<int> equilibrium;                    // coordinates that start without ringing
};

/// Contacts that hold together: of those that any set of the scene names, these and no others.
struct ContactSet {
  std::string name;
  std::vector<std::string> contacts;
};

/// A set of contacts that holds from a time on.
struct ContactPhase {
  double start = 0;  // s
  std::string set;
  double gap = 1e-9;  // m that a contact which closes may be off the ground
  Location where;
};

/// How a scene shares what redundant rows leave open: lambda_stat of eq. (26).
enum class LoadSharing { least_norm, equal_friction_utilisation };

/// Gives every constraint row a spring and a damper, so that no share of a load is left open (remark 7).
struct ContactElasticity {
  Exact stiffness = 0;  // N/m, of a row that turns N m/rad
  Exact damping = 0;    // N s/m, N m s/rad
};

struct Integrator {
  enum class Method { dopri5, rkmk4, dopri8, rkmk8, cf4, rodas5p, automatic };  // docs/integrators.md
  static constexpr std::array method_names = {"dopri5", "rkmk4",   "dopri8", "rkmk8",
                                              "cf4",    "rodas5p", "auto"};  // in this order
  Method method = Method::dopri5;
  double tolerance = 1e-9;  // of methods that choose their steps, absolute and relative
  double step = 0;          // s, of those that do not
  Location where;

  [[nodiscard]] const char* name() const { return method_names[static_cast<std::size_t>(method)]; }
  [[nodiscard]] bool has_fixed_step() const {
    return method == Method::rkmk4 || method == Method::rkmk8 || method == Method::cf4;
  }
};

/// Whether the method is, or may turn out to be, one that needs the Jacobian.
inline bool may_be_stiff(const Integrator& integrator) {
  return integrator.method == Integrator::Method::rodas5p ||
         integrator.method == Integrator::Method::automatic;
}

struct Scene {
  std::string name;
  std::string title;
  std::string file;    // base name
  std::string sha256;  // of its bytes
  std::filesystem::path model_file;
  Model model;                         // with the scene's parameter values; not specialised
  std::vector<std::string> functions;  // wanted; empty: every one that the model has
  std::vector<std::string> frozen;     // parameters that become numbers
  std::vector<LockedCoordinate> locked;
  std::vector<std::pair<int, int>> modes;  // (body, modes kept in each family)
  std::optional<Deformation> deformation;  // of all compliant bodies; empty: as the model says
  bool gravity = true;
  std::vector<std::string> torque_driven;  // active coordinates whose torque is imposed
  std::vector<ImposedMotion> motion;
  std::optional<MotionTable> motion_table;
  bool project_motion =
      false;  // an imposed motion that rows do not allow: moved to what they allow, or refused
  std::vector<ImposedTorque> torques;
  InitialState initial;
  Integrator integrator;
  std::vector<ContactSet> contact_sets;
  std::string contact_set;           // the one in force; empty where there are none
  std::vector<ContactPhase> phases;  // in the order of time; empty: one set all along
  std::optional<double> continuous;  // largest jump of the velocities at a switch that is allowed, relative
  LoadSharing sharing = LoadSharing::least_norm;
  std::optional<ContactElasticity> elasticity;
  std::string optimise = "balanced";  // aim of the optimiser: an option of the run, not of the file
  double duration = 0;                // s; 0: the scene is not to be simulated
  std::vector<double> output_times;  // s, increasing, within [0, duration]; empty: the integrator's own steps
  Location where, initial_where;     // of the scene and of its initial state, for messages

  /// Contacts that some set names and the one in force does not.
  [[nodiscard]] std::vector<std::string> open_contacts() const;
};

/// Name of the functions that a scene generates: its own, and that of the contact set in force.
std::string program_name(const Scene& scene);

/// Reads a scene and its model. @throws ModelError with everything that is wrong with either
Scene read_scene(const std::filesystem::path& path);

/// Likewise from text. @param path  stands in messages; the model's path is relative to its folder
Scene read_scene_text(std::string_view text, const std::filesystem::path& path);

/// Whether a file is a scene rather than the description of a robot. @throws ModelError where it cannot be
/// read
bool is_scene(const std::filesystem::path& path);

}  // namespace anholon
