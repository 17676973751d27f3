// SPDX-License-Identifier: GPL-2.0-or-later
#include <memory>

#include "contenders.hpp"
#include "layout.hpp"
#include "urdf/dart_skeleton.hpp"

namespace anholon::bench {
namespace {

struct Engine {
  explicit Engine(const Robot& r) : robot(r), twin(r.mechanism) {
    layout.at = twin.at;
    layout.free_base = r.mechanism.group == GroupKind::SE3;
    const auto vector = [](const std::vector<double>& v) {
      return Eigen::VectorXd(
          Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size())));
    };
    for (const Sample& s : r.samples) {
      std::vector<double> q;
      if (layout.free_base) q = testing::DartSkeleton::root_position(s.state.R, s.state.p);
      q.insert(q.end(), s.state.r.begin(), s.state.r.end());
      position.push_back(twin.theirs(q));
      velocity.push_back(vector(layout.velocity(s)));
      acceleration.push_back(vector(layout.acceleration(s)));
      force.push_back(vector(layout.force(s)));
    }
  }
  dart::dynamics::Skeleton& at(std::size_t i) {
    twin.skeleton->setPositions(position[i]);
    twin.skeleton->setVelocities(velocity[i]);
    return *twin.skeleton;
  }

  const Robot& robot;
  testing::DartSkeleton twin;
  Layout layout;
  std::vector<Eigen::VectorXd> position, velocity, acceleration, force;
};

}  // namespace

std::vector<Contender> dart_contenders(const Robot& robot, const std::string& function) {
  const auto e = std::make_shared<Engine>(robot);
  const std::size_t n = robot.samples.size();
  if (function == "inverse_dynamics")
    return {contender(
        "DART, computeInverseDynamics", n,
        [e](std::size_t i) {
          e->at(i).setAccelerations(e->acceleration[i]);
          e->twin.skeleton->computeInverseDynamics();
        },
        [e](std::size_t i) {
          return e->layout.our_force(e->robot.samples[i], entries_of(e->twin.skeleton->getForces()));
        })};
  if (function == "forward_dynamics")
    return {contender(
        "DART, computeForwardDynamics", n,
        [e](std::size_t i) {
          e->at(i).setForces(e->force[i]);
          e->twin.skeleton->computeForwardDynamics();
        },
        [e](std::size_t i) {
          return e->layout.our_acceleration(e->robot.samples[i],
                                            entries_of(e->twin.skeleton->getAccelerations()));
        })};
  if (function == "mass_matrix")
    return {contender(
        "DART, getMassMatrix", n, [e](std::size_t i) { e->at(i).getMassMatrix(); },
        [e](std::size_t i) {
          return e->layout.our_matrix(e->robot.samples[i],
                                      matrix_entries_of(e->twin.skeleton->getMassMatrix()));
        })};
  return {};
}

}  // namespace anholon::bench
