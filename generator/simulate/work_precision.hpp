// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Error against cost: one scene, integrated by its method along a ladder of tolerances, or of steps where
// they are fixed, by generated code in double and in float, by the numeric recursion and by whoever else
// knows the scene, on past the rounding floor, so that the floor is seen.

#include <functional>
#include <string>
#include <vector>

#include "describe/scene.hpp"

namespace anholon {

/// One way to compute at one rung of the ladder.
struct WorkPrecisionPoint {
  std::string code;      // "generated", "generated, float", "recursion", or a peer's name
  double tolerance = 0;  // or step, s
  double error = 0;      // of the final state, see state_error()
  double cpu_seconds = 0;
  long evaluations = 0;
  std::string status;
};

struct WorkPrecision {
  bool by_step = false;                    // a ladder of steps
  std::vector<WorkPrecisionPoint> points;  // rung by rung, in the order of the codes
  std::string reference_method;            // in long double
  long reference_steps = 0;
  double reference_error = 0;  // how far the reference moves when its steps are doubled
};

/// Where the error of one code stops falling.
struct RoundingFloor {
  double error = 0;      // the smallest of the ladder
  double tolerance = 0;  // or step, the largest at which the error is within twice the smallest
  bool seen = false;     // the ladder goes on for two rungs below it
};
RoundingFloor rounding_floor(const WorkPrecision& result, const std::string& code);

/// Another engine that knows the scene and integrates it by a method of its own.
struct Peer {
  struct Run {
    std::vector<double> state;  // as final_values() of the reduced state
    double cpu_seconds = 0;
    long evaluations = 0;
    std::string status = "ok";
  };
  std::string name;
  std::function<Run(double tolerance)> run;
};

/// Powers of ten of the tolerances, or of two of the steps as parts of the duration, and which codes. The
/// tightest is beyond what double can resolve: an error of it cannot fall below 1e-16, and has risen again by
/// then where steps are many. Functions of float run in an integration in double, and only down to
/// single_tightest: below their own rounding more steps bring nothing.
struct Ladder {
  int loosest = -3, tightest = -18;
  bool recursion = true, single = false;
  int single_tightest = -9;
  std::vector<Peer> peers{};
};

/// @param on_point  called after each point; may be empty
/// @throws ModelError, CompileError, UnfitSceneError for a scene without duration or of several phases,
/// UnsupportedError for a projected motion
WorkPrecision work_precision(const Scene& scene,
                             const std::function<void(const WorkPrecisionPoint&)>& on_point = {},
                             const Ladder& ladder = {});

}  // namespace anholon
