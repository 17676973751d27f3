// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A scene, generated, compiled and integrated: trajectory, torques, constraint forces, energies.

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "describe/scene.hpp"

namespace anholon {

/// A change of contacts on the way, and what it did.
struct ContactSwitch {
  double t = 0;
  std::string from, to;       // contact sets
  double lost = 0, work = 0;  // J: by the impact; by the motors' impulses
  double relative = 0;        // jump of the velocities in the kinetic metric, 0 to 1
  std::vector<std::pair<std::string, double>> impulses;  // by row, N s or N m s
};

/// What one contact with the ground carried.
struct ContactHistory {
  std::string contact;
  bool has_normal = false, has_friction = false;
  double least_normal = 0, least_normal_at = 0;        // N, s
  double largest_utilisation = 0, utilisation_at = 0;  // |tangential|/(mu normal), s
  std::optional<double> lifts_at, slips_at;            // first time that the ground would pull; give way
};

/// What rounding does to the reduced accelerations at one instant (rounding_monitor.hpp).
struct RoundingLoss {
  double t = 0;      // s
  double error = 0;  // largest, relative to the largest entry; infinite where one is not finite
  double least = 0;  // what rounding each input and parameter alone makes of it; known where error is large
  /// Digits are lost inside the function: its error is beyond this and ten times what the inputs explain.
  static constexpr double large = 1e-6;
  [[nodiscard]] bool is_loss() const { return error > large && !(error <= 10 * least); }
};

/// A trajectory and what was seen on the way.
struct SimulationResult {
  std::vector<std::string> columns;  // with units: "V_X [m/s]"
  std::vector<std::vector<double>> rows;
  std::string status;  // "ok", or why the integration stopped
  bool finished = false;
  long steps = 0, rejected = 0, evaluations = 0;
  Integrator::Method method = Integrator::Method::dopri5;  // that integrated
  std::string why;                                         // it was chosen, where the scene leaves the choice
  long jacobians = 0;
  int jacobian_operations = 0;  // of one of them
  double cpu_seconds = 0;       // of the integration alone
  double nanoseconds_per_evaluation = 0;
  double energy_balance = 0;  // largest |E(t) - E(0) - work + dissipation| / largest_energy, at all steps
  double largest_energy = 0;  // of kinetic, change of potential, work, dissipated [J]
  double constraint_residual = 0;  // largest |A eta + B r_dot| relative to what cancels
  double position_residual = 0;    // largest residual of a condition on the position [m or 1]
  double orthonormality = 0;       // largest ||R^T R - 1||
  int operations = 0;              // of one evaluation of the field
  std::string class_of_table_I;
  std::size_t charts = 1;             // of the kernel
  bool projected = false;             // the imposed motion, to a compatible one
  double departure = 0;               // largest distance of r_a from what the scene wants [rad or m]
  std::vector<double> chart_changes;  // times at which the motion went on in another chart [s]
  std::vector<ContactSwitch> switches;
  std::vector<ContactHistory> contacts;
  RoundingLoss rounding;  // at the start or the end of a phase, the worst
  std::string violation;  // the first compatibility condition that the imposed motion violates, and when
};

/// Told what is being done, and the time that the motion has reached [s]; called at every step.
using Progress = std::function<void(const char* stage, double t)>;

struct SceneProgram;
template <class S>
class Runner;
/// Told of each row of the trajectory, with the state in the buffers.
using RowObserver = std::function<void(const SceneProgram& program, Runner<double>& run)>;

/// The scene is right, but describes no motion of the kind that is asked for. An error of its own, so that
/// who goes through many scenes may leave this one out.
class UnfitSceneError : public ModelError {
 public:
  using ModelError::ModelError;
};

/// @throws ModelError, CompileError, UnfitSceneError for a scene without duration
SimulationResult simulate_scene(const Scene& scene, const Progress& progress = {},
                                const RowObserver& observer = {});

/// @throws UnfitSceneError where the scene has no duration
void require_duration(const Scene& scene);

/// @throws UnfitSceneError at the second phase, where the scene has one. @param why  what asks for one alone
void require_one_phase(const Scene& scene, const std::string& why);

/// The trajectory as comma-separated values, one line of names with units first; empty where a phase has no
/// such quantity.
std::string trajectory_csv(const SimulationResult& result);

}  // namespace anholon
