// SPDX-License-Identifier: GPL-2.0-or-later
#include "snakeboard_motion.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "check/compile_cache.hpp"
#include "derive/derive.hpp"
#include "report/motion_json.hpp"
#include "simulate/work_precision.hpp"
#ifdef ANHOLON_HAVE_SIMBODY
#include "simbody_snakeboard.hpp"
#endif

namespace anholon::bench {
namespace {

using nlohmann::ordered_json;

#ifdef ANHOLON_HAVE_SIMBODY
double parameter(const Model& model, const std::string& name) {
  const auto found = std::ranges::find(model.parameters, name, &Parameter::name);
  if (found == model.parameters.end())
    throw std::invalid_argument(model.name + " has no parameter '" + name + "': not the rigid snake-board");
  return found->value.to_double();
}

/// Simbody's end as the scene's reduced state: R, p, nu, the latter by the kernel of the model's own basis.
Peer simbody(const Scene& scene) {
  const Model& model = scene.model;
  const SnakeboardFigures figures = {
      parameter(model, "m_p"), parameter(model, "J_p"), parameter(model, "l"),  parameter(model, "m_a"),
      parameter(model, "J_a"), parameter(model, "J_h"), parameter(model, "J_r")};
  DeriveRequest request;
  request.functions = {"kinematics"};
  const auto kinematics = std::make_shared<CompiledProgram>(derive(model, request)->program);
  const double duration = scene.duration;
  return {
      "Simbody", [figures, kinematics, duration](double tolerance) {
        Peer::Run run;
        if (tolerance < 1e-13) {
          run.status = "left out: below its rounding";
          return run;
        }
        const SnakeboardEnd end = simbody_snakeboard(figures, duration, tolerance);
        run.cpu_seconds = end.cpu_seconds;
        run.evaluations = end.evaluations;
        const double r_1 = 0.5 * std::sin(2.5 * duration), r_3 = 0.7 * std::cos(2.5 * duration);
        const std::vector<double> h =
            kinematics->call("kinematics", {{"r_a", {r_1, r_3}}, {"r_a_dot", {0, 0}}, {"nu", {1}}}).at("eta");
        const double nu = (h[0] * end.V_X + h[1] * end.V_Y + h[2] * end.Omega_Z) /
                          (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
        const double c = std::cos(end.theta), s = std::sin(end.theta);
        run.state = {c, -s, 0, s, c, 0, 0, 0, 1, end.x, end.y, 0, nu};
        return run;
      }};
}
#endif

}  // namespace

ordered_json snakeboard_motion(const std::string& file) {
  const Scene scene = read_scene(file);
  Ladder ladder;
  ladder.tightest = -16;
  ladder.single = true;
#ifdef ANHOLON_HAVE_SIMBODY
  ladder.peers.push_back(simbody(scene));
#endif
  return {{"model", scene.model.name},
          {"scene", scene.name},
          {"duration_s", scene.duration},
          {"ladder", to_json(scene, work_precision(scene, {}, ladder))}};
}

}  // namespace anholon::bench
