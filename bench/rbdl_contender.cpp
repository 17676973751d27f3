// SPDX-License-Identifier: GPL-2.0-or-later

// RBDL's free base: velocity of the origin in world axes, angular velocity in its own; the quaternion's real
// part stands behind all other coordinates.

#include <rbdl/rbdl.h>

#include <memory>

#include "contenders.hpp"
#include "layout.hpp"
#include "urdf/central_inertia.hpp"

namespace anholon::bench {
namespace {

namespace rbdl = RigidBodyDynamics;

rbdl::Math::Vector3d vector(const Vec3<double>& v) { return rbdl::Math::Vector3d(v.x, v.y, v.z); }
rbdl::Math::Matrix3d matrix(const Mat3<double>& m) {
  return rbdl::Math::Matrix3d(m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1),
                              m(2, 2));
}
rbdl::Math::VectorNd vector(const std::vector<double>& v) {
  rbdl::Math::VectorNd r(static_cast<Eigen::Index>(v.size()));
  for (std::size_t i = 0; i < v.size(); ++i) r[static_cast<Eigen::Index>(i)] = v[i];
  return r;
}

struct Engine {
  explicit Engine(const Robot& r) : robot(r) {
    const Mechanism<double>& m = r.mechanism;
    layout.free_base = layout.linear_in_world = m.group == GroupKind::SE3;
    model.gravity = vector(m.gravity);
    std::vector<unsigned> of_body, of_coordinate(static_cast<std::size_t>(m.coordinates));
    for (const Body<double>& b : m.bodies) {
      if (b.parent < 0 && !layout.free_base) {
        of_body.push_back(0);
        continue;
      }
      Vec3<double> centre;
      const Mat3<double> I = testing::central_inertia(b, centre);
      const rbdl::Body body(b.mass, vector(centre), matrix(I));
      if (b.parent < 0) {
        of_body.push_back(model.AddBody(0, rbdl::Math::SpatialTransform(),
                                        rbdl::Joint(rbdl::JointTypeFloatingBase), body, b.name));
      } else {
        of_body.push_back(model.AddBody(
            of_body[static_cast<std::size_t>(b.parent)],
            rbdl::Math::SpatialTransform(matrix(b.R.transposed()), vector(b.p)),
            rbdl::Joint(b.kind == JointKind::revolute ? rbdl::JointTypeRevolute : rbdl::JointTypePrismatic,
                        vector(unit<double>(b.axis))),
            body, b.name));
      }
      if (b.coordinate >= 0) of_coordinate[static_cast<std::size_t>(b.coordinate)] = of_body.back();
    }
    if (layout.free_base) {
      for (std::size_t c = 0; c < 6; ++c) layout.at.push_back(c);
    }
    for (const unsigned body : of_coordinate) layout.at.push_back(model.mJoints[body].q_index);
    for (const Sample& s : r.samples) {
      rbdl::Math::VectorNd q = rbdl::Math::VectorNd::Zero(model.q_size);
      if (layout.free_base) {
        const auto& [w, x, y, z] = s.quaternion_wxyz;
        model.SetQuaternion(of_body[0], rbdl::Math::Quaternion(x, y, z, w), q);
      }
      for (std::size_t i = 0; i < of_coordinate.size(); ++i)
        q[model.mJoints[of_coordinate[i]].q_index] = s.state.r[i];
      position.push_back(q);
      velocity.push_back(vector(layout.velocity(s)));
      acceleration.push_back(vector(layout.acceleration(s)));
      force.push_back(vector(layout.force(s)));
    }
    result = rbdl::Math::VectorNd::Zero(model.qdot_size);
    H = rbdl::Math::MatrixNd::Zero(model.qdot_size, model.qdot_size);
  }

  const Robot& robot;
  rbdl::Model model;
  Layout layout;
  std::vector<rbdl::Math::VectorNd> position, velocity, acceleration, force;
  rbdl::Math::VectorNd result;
  rbdl::Math::MatrixNd H;
};

}  // namespace

std::vector<Contender> rbdl_contenders(const Robot& robot, const std::string& function) {
  const auto e = std::make_shared<Engine>(robot);
  const std::size_t n = robot.samples.size();
  if (function == "inverse_dynamics")
    return {contender(
        "RBDL, InverseDynamics", n,
        [e](std::size_t i) {
          rbdl::InverseDynamics(e->model, e->position[i], e->velocity[i], e->acceleration[i], e->result);
        },
        [e](std::size_t i) { return e->layout.our_force(e->robot.samples[i], entries_of(e->result)); })};
  if (function == "forward_dynamics")
    return {contender(
        "RBDL, ForwardDynamics", n,
        [e](std::size_t i) {
          rbdl::ForwardDynamics(e->model, e->position[i], e->velocity[i], e->force[i], e->result);
        },
        [e](std::size_t i) {
          return e->layout.our_acceleration(e->robot.samples[i], entries_of(e->result));
        })};
  if (function == "mass_matrix")
    return {contender(
        "RBDL, CompositeRigidBodyAlgorithm", n,
        [e](std::size_t i) {
          e->H.setZero();  // it writes what is not structurally zero
          rbdl::CompositeRigidBodyAlgorithm(e->model, e->position[i], e->H);
        },
        [e](std::size_t i) { return e->layout.our_matrix(e->robot.samples[i], matrix_entries_of(e->H)); })};
  return {};
}

}  // namespace anholon::bench
