// SPDX-License-Identifier: GPL-2.0-or-later

// The robot is handed to MuJoCo as MJCF that is written from the mechanism, so that both see the same
// numbers; MuJoCo then turns each body's frame to its principal axes, which costs it some digits.

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>

#include "contenders.hpp"
#include "layout.hpp"
#include "motion.hpp"
#include "simulate/cpu_time.hpp"
#include "urdf/central_inertia.hpp"

namespace anholon::bench {
namespace {

std::string text(const Vec3<double>& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }
std::string axes(const Mat3<double>& R) {
  return fmt::format("{} {} {} {} {} {}", R(0, 0), R(1, 0), R(2, 0), R(0, 1), R(1, 1), R(2, 1));
}

/// A body with all that hangs on it. Body 0 of a robot on a fixed base is the world.
std::string body_text(const Mechanism<double>& m, std::size_t k) {
  const Body<double>& b = m.bodies[k];
  const bool is_world = k == 0 && m.group == GroupKind::fixed;
  std::string xml;
  if (!is_world) {
    Vec3<double> c;
    const Mat3<double> I = testing::central_inertia(b, c);
    xml += fmt::format("<body name='b{}' pos='{}' xyaxes='{}'>\n", k, text(b.p), axes(b.R));
    if (b.kind == JointKind::fixed) {
      xml += k == 0 ? "<freejoint/>\n" : "";
    } else {
      xml += fmt::format("<joint name='j{}' type='{}' axis='{}'/>\n", b.coordinate,
                         b.kind == JointKind::revolute ? "hinge" : "slide", text(unit<double>(b.axis)));
    }
    xml += fmt::format("<inertial pos='{}' mass='{}' fullinertia='{} {} {} {} {} {}'/>\n", text(c), b.mass,
                       I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  }
  for (std::size_t i = k + 1; i < m.bodies.size(); ++i) {
    if (m.bodies[i].parent == static_cast<int>(k)) xml += body_text(m, i);
  }
  return xml + (is_world ? "" : "</body>\n");
}

std::string mjcf(const Mechanism<double>& m) {
  return fmt::format(
      "<mujoco><compiler angle='radian' balanceinertia='true'/>"
      "<option gravity='{}'><flag constraint='disable' contact='disable' passive='disable' limit='disable' "
      "equality='disable' frictionloss='disable'/></option>\n<worldbody>\n{}</worldbody></mujoco>\n",
      text(m.gravity), body_text(m, 0));
}

struct Engine {
  struct Row {
    std::vector<double> position, velocity, acceleration, force;
  };
  struct Delete {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };

  explicit Engine(const Robot& r) : robot(r) {
    layout.free_base = layout.linear_in_world = r.mechanism.group == GroupKind::SE3;
    const std::string xml = mjcf(r.mechanism);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    if (mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(xml.size())) != 0)
      throw std::runtime_error("MuJoCo takes no model of this size");
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    std::array<char, 1000> message{};
    model.reset(mj_loadXML("robot.xml", files.get(), message.data(), static_cast<int>(message.size())));
    mj_deleteVFS(files.get());
    if (!model) throw std::runtime_error(fmt::format("MuJoCo: {}", message.data()));
    data.reset(mj_makeData(model.get()));
    if (layout.free_base) {
      for (std::size_t c = 0; c < 6; ++c) layout.at.push_back(c);
    }
    std::vector<std::size_t> position;
    for (std::size_t i = 0; i < r.model.coordinates.size(); ++i) {
      const int joint = mj_name2id(model.get(), mjOBJ_JOINT, fmt::format("j{}", i).c_str());
      position.push_back(static_cast<std::size_t>(model->jnt_qposadr[joint]));
      layout.at.push_back(static_cast<std::size_t>(model->jnt_dofadr[joint]));
    }
    for (const Sample& s : r.samples) {
      std::vector<double> q(static_cast<std::size_t>(model->nq), 0.0);
      if (layout.free_base) std::copy(s.quaternion_wxyz.begin(), s.quaternion_wxyz.end(), q.begin() + 3);
      for (std::size_t i = 0; i < position.size(); ++i) q[position[i]] = s.state.r[i];
      rows.push_back({q, layout.velocity(s), layout.acceleration(s), layout.force(s)});
    }
  }

  void inverse(std::size_t i) {
    load(i);
    mju_copy(data->qacc, rows[i].acceleration.data(), model->nv);
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());
    mj_comVel(model.get(), data.get());
    mj_rne(model.get(), data.get(), 1, data->qfrc_inverse);
  }
  void forward(std::size_t i) {
    load(i);
    mju_copy(data->qfrc_applied, rows[i].force.data(), model->nv);
    mj_forwardSkip(model.get(), data.get(), mjSTAGE_NONE, 1);
  }
  void mass_matrix(std::size_t i) {
    load(i);
    mj_kinematics(model.get(), data.get());
    mj_comPos(model.get(), data.get());
    mj_crb(model.get(), data.get());
  }
  [[nodiscard]] std::vector<double> full_mass_matrix(std::size_t i) const {
    const auto nv = static_cast<std::size_t>(model->nv);
    std::vector<double> M(nv * nv);
    mj_fullM(model.get(), M.data(), data->qM);
    return layout.our_matrix(robot.samples[i], [&](std::size_t r, std::size_t c) { return M[nv * r + c]; });
  }

  void load(std::size_t i) {
    mju_copy(data->qpos, rows[i].position.data(), model->nq);
    mju_copy(data->qvel, rows[i].velocity.data(), model->nv);
  }

  const Robot& robot;
  Layout layout;
  std::unique_ptr<mjModel, Delete> model;
  std::unique_ptr<mjData, Delete> data;
  std::vector<Row> rows;
};

}  // namespace

std::vector<Contender> mujoco_contenders(const Robot& robot, const std::string& function) {
  const auto e = std::make_shared<Engine>(robot);
  const std::size_t n = robot.samples.size();
  // its principal axes of inertia: nine digits, and what the condition of the mass matrix makes of them
  constexpr double digits = 1e-6;
  const auto entry = [](const double* v) { return [v](std::size_t i) { return v[i]; }; };
  if (function == "inverse_dynamics")
    return {contender(
        "MuJoCo, mj_rne path", n, [e](std::size_t i) { e->inverse(i); },
        [e, entry](std::size_t i) {
          return e->layout.our_force(e->robot.samples[i], entry(e->data->qfrc_inverse));
        },
        digits)};
  if (function == "forward_dynamics")
    return {contender(
        "MuJoCo, mj_forward", n, [e](std::size_t i) { e->forward(i); },
        [e, entry](std::size_t i) {
          return e->layout.our_acceleration(e->robot.samples[i], entry(e->data->qacc));
        },
        digits)};
  if (function == "mass_matrix")
    return {contender(
        "MuJoCo, mj_crb path", n, [e](std::size_t i) { e->mass_matrix(i); },
        [e](std::size_t i) { return e->full_mass_matrix(i); }, digits)};
  return {};
}

MotionRun mujoco_motion(const Robot& robot, double duration, long steps) {
  Engine e(robot);
  e.model->opt.integrator = mjINT_RK4;
  e.model->opt.timestep = duration / static_cast<double>(steps);
  e.load(0);
  const double start = cpu_now();
  for (long i = 0; i < steps; ++i) mj_step(e.model.get(), e.data.get());
  MotionRun run;
  run.cpu_seconds = cpu_now() - start;
  run.evaluations = 4 * steps;
  if (e.layout.free_base) {
    const mjtNum *const q = e.data->qpos, *const v = e.data->qvel;
    run.end = free_base({q[3], q[4], q[5], q[6]}, {q[0], q[1], q[2]}, {v[0], v[1], v[2]}, {v[3], v[4], v[5]});
  }
  for (std::size_t i = 0; i < robot.model.coordinates.size(); ++i) {
    const int joint = mj_name2id(e.model.get(), mjOBJ_JOINT, fmt::format("j{}", i).c_str());
    run.end.position.push_back(e.data->qpos[e.model->jnt_qposadr[joint]]);
    run.end.velocity.push_back(e.data->qvel[e.model->jnt_dofadr[joint]]);
  }
  return run;
}

}  // namespace anholon::bench
