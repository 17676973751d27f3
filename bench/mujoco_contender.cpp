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
    const Vec3<double> c = (1 / b.mass) * b.first_moment;
    const auto central = [&](int i, int j) {
      return b.inertia(i, j) - b.mass * ((i == j ? dot(c, c) : 0.0) - c[i] * c[j]);
    };
    xml += fmt::format("<body name='b{}' pos='{}' xyaxes='{}'>\n", k, text(b.p), axes(b.R));
    if (b.kind == JointKind::fixed) {
      xml += k == 0 ? "<freejoint/>\n" : "";
    } else {
      xml += fmt::format("<joint name='j{}' type='{}' axis='{}'/>\n", b.coordinate,
                         b.kind == JointKind::revolute ? "hinge" : "slide", text(unit<double>(b.axis)));
    }
    xml +=
        fmt::format("<inertial pos='{}' mass='{}' fullinertia='{} {} {} {} {} {}'/>\n", text(c), b.mass,
                    central(0, 0), central(1, 1), central(2, 2), central(0, 1), central(0, 2), central(1, 2));
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

std::array<double, 4> quaternion(const Mat3<double>& R) {
  std::array<double, 4> q{};
  mju_mat2Quat(q.data(), R.m.data());
  return q;
}

class Engine {
 public:
  explicit Engine(const Robot& robot) : floating_(robot.mechanism.group == GroupKind::SE3) {
    const std::string xml = mjcf(robot.mechanism);
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    if (mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(xml.size())) != 0)
      throw std::runtime_error("MuJoCo takes no model of this size");
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    std::array<char, 1000> message{};
    model_.reset(mj_loadXML("robot.xml", files.get(), message.data(), static_cast<int>(message.size())));
    mj_deleteVFS(files.get());
    if (!model_) throw std::runtime_error(fmt::format("MuJoCo: {}", message.data()));
    data_.reset(mj_makeData(model_.get()));
    for (std::size_t i = 0; i < robot.model.coordinates.size(); ++i) {
      const int joint = mj_name2id(model_.get(), mjOBJ_JOINT, fmt::format("j{}", i).c_str());
      position_.push_back(static_cast<std::size_t>(model_->jnt_qposadr[joint]));
      velocity_.push_back(static_cast<std::size_t>(model_->jnt_dofadr[joint]));
    }
    for (const Sample& s : robot.samples) add(s);
  }

  void inverse(std::size_t i) {
    mjModel* const m = model_.get();
    mjData* const d = data_.get();
    load(i);
    mju_copy(d->qacc, rows_[i].acceleration.data(), m->nv);
    mj_kinematics(m, d);
    mj_comPos(m, d);
    mj_comVel(m, d);
    mj_rne(m, d, 1, d->qfrc_inverse);
  }
  void forward(std::size_t i) {
    load(i);
    mju_copy(data_->qfrc_applied, rows_[i].force.data(), model_->nv);
    mj_forwardSkip(model_.get(), data_.get(), mjSTAGE_NONE, 1);
  }
  void mass_matrix(std::size_t i) {
    load(i);
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
    mj_crb(model_.get(), data_.get());
  }
  /// (base wrench, joint forces) in the generator's axes and order.
  std::vector<double> inverse_values(std::size_t i) {
    inverse(i);
    return in_body_axes(i, data_->qfrc_inverse);
  }
  /// (eta_dot, r_ddot): MuJoCo's linear acceleration is that of the origin in world axes.
  std::vector<double> forward_values(std::size_t i) {
    forward(i);
    std::vector<double> v = in_body_axes(i, data_->qacc);
    if (floating_) {
      const Vec3<double> drift = cross(rows_[i].eta.angular, rows_[i].eta.linear);
      for (int c = 0; c < 3; ++c) v[static_cast<std::size_t>(c)] -= drift[c];
    }
    return v;
  }
  [[nodiscard]] std::size_t size() const { return rows_.size(); }

 private:
  struct Row {
    std::vector<double> position, velocity, acceleration, force;
    Mat3<double> R;
    Spatial<double> eta;
  };

  void add(const Sample& s) {
    Row row;
    row.position.resize(static_cast<std::size_t>(model_->nq));
    for (auto* v : {&row.velocity, &row.acceleration, &row.force})
      v->resize(static_cast<std::size_t>(model_->nv));
    row.R = s.state.R;
    row.eta = s.state.eta;
    if (floating_) {
      const auto q = quaternion(s.state.R);
      std::copy(q.begin(), q.end(), row.position.begin() + 3);
      const Vec3<double> v = s.state.R * s.state.eta.linear;
      const Vec3<double> a = s.state.R * (s.eta_dot.linear + cross(s.state.eta.angular, s.state.eta.linear));
      for (int c = 0; c < 3; ++c) {
        const auto at = static_cast<std::size_t>(c);
        row.velocity[at] = v[c], row.velocity[at + 3] = s.state.eta.angular[c];
        row.acceleration[at] = a[c], row.acceleration[at + 3] = s.eta_dot.angular[c];
      }
    }
    for (std::size_t i = 0; i < s.state.r.size(); ++i) {
      row.position[position_[i]] = s.state.r[i];
      row.velocity[velocity_[i]] = s.state.r_dot[i];
      row.acceleration[velocity_[i]] = s.r_ddot[i];
      row.force[velocity_[i]] = s.tau[i];
    }
    rows_.push_back(std::move(row));
  }
  void load(std::size_t i) {
    mju_copy(data_->qpos, rows_[i].position.data(), model_->nq);
    mju_copy(data_->qvel, rows_[i].velocity.data(), model_->nv);
  }
  std::vector<double> in_body_axes(std::size_t i, const double* v) const {
    std::vector<double> result;
    if (floating_) {
      const Vec3<double> linear = transposed_times(rows_[i].R, Vec3<double>{v[0], v[1], v[2]});
      result = {linear.x, linear.y, linear.z, v[3], v[4], v[5]};
    }
    for (const std::size_t at : velocity_) result.push_back(v[at]);
    return result;
  }

  struct Delete {
    void operator()(mjModel* m) const { mj_deleteModel(m); }
    void operator()(mjData* d) const { mj_deleteData(d); }
  };
  bool floating_;
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  std::vector<std::size_t> position_, velocity_;  // of each coordinate in qpos and in qvel
  std::vector<Row> rows_;
};

}  // namespace

std::vector<Contender> mujoco_contenders(const Robot& robot, const std::string& function) {
  const auto engine = std::make_shared<Engine>(robot);
  const auto all = [engine](void (Engine::*call)(std::size_t)) {
    return [engine, call] {
      for (std::size_t i = 0; i < engine->size(); ++i) (engine.get()->*call)(i);
    };
  };
  if (function == "inverse_dynamics")
    return {{"MuJoCo, mj_rne path", all(&Engine::inverse),
             [engine](std::size_t i) { return engine->inverse_values(i); }}};
  if (function == "forward_dynamics")
    return {{"MuJoCo, mj_forward", all(&Engine::forward),
             [engine](std::size_t i) { return engine->forward_values(i); }}};
  if (function == "mass_matrix") return {{"MuJoCo, mj_crb path", all(&Engine::mass_matrix), {}}};
  return {};
}

}  // namespace anholon::bench
