// SPDX-License-Identifier: GPL-2.0-or-later
#include <algorithm>
#include <memory>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/joint/joints.hpp>
#include <pinocchio/multibody/model.hpp>

#include "contenders.hpp"
#include "layout.hpp"
#include "urdf/central_inertia.hpp"

namespace anholon::bench {
namespace {

Eigen::Vector3d eigen(const Vec3<double>& v) { return {v.x, v.y, v.z}; }
Eigen::Matrix3d eigen(const Mat3<double>& m) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(m.m.data());
}
Eigen::VectorXd eigen(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

struct Engine {
  explicit Engine(const Robot& r) : robot(r) {
    const Mechanism<double>& m = r.mechanism;
    layout.free_base = m.group == GroupKind::SE3;
    model.gravity.linear(eigen(m.gravity));
    std::vector<pinocchio::JointIndex> of_body, of_coordinate(static_cast<std::size_t>(m.coordinates));
    for (const Body<double>& b : m.bodies) {
      if (b.parent < 0 && !layout.free_base) {
        of_body.push_back(0);
        continue;
      }
      const pinocchio::JointIndex parent = b.parent < 0 ? 0 : of_body[static_cast<std::size_t>(b.parent)];
      const pinocchio::SE3 pose =
          b.parent < 0 ? pinocchio::SE3::Identity() : pinocchio::SE3(eigen(b.R), eigen(b.p));
      of_body.push_back(model.addJoint(parent, joint(b), pose, b.name));
      Vec3<double> centre;
      const Mat3<double> I = testing::central_inertia(b, centre);
      model.appendBodyToJoint(of_body.back(), pinocchio::Inertia(b.mass, eigen(centre), eigen(I)),
                              pinocchio::SE3::Identity());
      if (b.coordinate >= 0) of_coordinate[static_cast<std::size_t>(b.coordinate)] = of_body.back();
    }
    data = std::make_unique<pinocchio::Data>(model);
    if (layout.free_base) {  // body axes, linear part first, like ours
      for (std::size_t c = 0; c < 6; ++c) layout.at.push_back(c);
    }
    for (const pinocchio::JointIndex j : of_coordinate)
      layout.at.push_back(static_cast<std::size_t>(model.joints[j].idx_v()));
    for (const Sample& s : r.samples) {
      Eigen::VectorXd q = Eigen::VectorXd::Zero(model.nq);
      if (layout.free_base) {
        const auto& [w, x, y, z] = s.quaternion_wxyz;
        q.segment<4>(3) << x, y, z, w;
      }
      for (std::size_t i = 0; i < of_coordinate.size(); ++i)
        q[model.joints[of_coordinate[i]].idx_q()] = s.state.r[i];
      position.push_back(q);
      velocity.push_back(eigen(layout.velocity(s)));
      acceleration.push_back(eigen(layout.acceleration(s)));
      force.push_back(eigen(layout.force(s)));
    }
  }

  static pinocchio::JointModel joint(const Body<double>& b) {
    if (b.parent < 0) return pinocchio::JointModelFreeFlyer();
    if (b.kind == JointKind::revolute) {
      if (b.axis == 0) return pinocchio::JointModelRX();
      if (b.axis == 1) return pinocchio::JointModelRY();
      return pinocchio::JointModelRZ();
    }
    if (b.axis == 0) return pinocchio::JointModelPX();
    if (b.axis == 1) return pinocchio::JointModelPY();
    return pinocchio::JointModelPZ();
  }

  const Robot& robot;
  pinocchio::Model model;
  std::unique_ptr<pinocchio::Data> data;
  Layout layout;
  std::vector<Eigen::VectorXd> position, velocity, acceleration, force;
};

}  // namespace

std::vector<Contender> pinocchio_contenders(const Robot& robot, const std::string& function) {
  const auto e = std::make_shared<Engine>(robot);
  const std::size_t n = robot.samples.size();
  if (function == "inverse_dynamics")
    return {contender(
        "Pinocchio, rnea", n,
        [e](std::size_t i) {
          pinocchio::rnea(e->model, *e->data, e->position[i], e->velocity[i], e->acceleration[i]);
        },
        [e](std::size_t i) { return e->layout.our_force(e->robot.samples[i], entries_of(e->data->tau)); })};
  if (function == "forward_dynamics")
    return {contender(
        "Pinocchio, aba", n,
        [e](std::size_t i) {
          pinocchio::aba(e->model, *e->data, e->position[i], e->velocity[i], e->force[i]);
        },
        [e](std::size_t i) {
          return e->layout.our_acceleration(e->robot.samples[i], entries_of(e->data->ddq));
        })};
  if (function == "mass_matrix")
    return {contender(
        "Pinocchio, crba", n, [e](std::size_t i) { pinocchio::crba(e->model, *e->data, e->position[i]); },
        [e](std::size_t i) {
          const auto upper = [&](std::size_t r, std::size_t c) {  // crba leaves the rest alone
            return e->data->M(static_cast<Eigen::Index>(std::min(r, c)),
                              static_cast<Eigen::Index>(std::max(r, c)));
          };
          return e->layout.our_matrix(e->robot.samples[i], upper);
        })};
  return {};
}

}  // namespace anholon::bench
