// SPDX-License-Identifier: GPL-2.0-or-later
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <memory>

#include "contenders.hpp"
#include "urdf/kdl_chain.hpp"

namespace anholon::bench {
namespace {

KDL::JntArray array(const std::vector<double>& v) {
  KDL::JntArray a(static_cast<unsigned>(v.size()));
  for (unsigned i = 0; i < v.size(); ++i) a(i) = v[i];
  return a;
}

struct Engine {
  explicit Engine(const Robot& robot)
      : chain(testing::chain_of(robot.mechanism)),
        gravity(robot.mechanism.gravity.x, robot.mechanism.gravity.y, robot.mechanism.gravity.z),
        inverse(chain, gravity),
        forward(chain, gravity),
        parameters(chain, gravity),
        no_wrenches(chain.getNrOfSegments(), KDL::Wrench::Zero()),
        result(chain.getNrOfJoints()),
        M(chain.getNrOfJoints()) {
    for (const Sample& s : robot.samples) {
      r.push_back(array(s.state.r));
      r_dot.push_back(array(s.state.r_dot));
      r_ddot.push_back(array(s.r_ddot));
      tau.push_back(array(s.tau));
    }
  }
  [[nodiscard]] std::vector<double> values() const {
    return {result.data.data(), result.data.data() + result.data.size()};
  }

  KDL::Chain chain;
  KDL::Vector gravity;
  KDL::ChainIdSolver_RNE inverse;
  KDL::ChainFdSolver_RNE forward;
  KDL::ChainDynParam parameters;
  KDL::Wrenches no_wrenches;
  KDL::JntArray result;
  KDL::JntSpaceInertiaMatrix M;
  std::vector<KDL::JntArray> r, r_dot, r_ddot, tau;
};

}  // namespace

std::vector<Contender> kdl_contenders(const Robot& robot, const std::string& function) {
  if (robot.mechanism.group != GroupKind::fixed || !testing::is_chain(robot.mechanism)) return {};
  const auto e = std::make_shared<Engine>(robot);
  const std::size_t n = robot.samples.size();
  const auto values = [e](std::size_t) { return e->values(); };
  if (function == "inverse_dynamics")
    return {contender(
        "KDL, ChainIdSolver_RNE", n,
        [e](std::size_t i) {
          e->inverse.CartToJnt(e->r[i], e->r_dot[i], e->r_ddot[i], e->no_wrenches, e->result);
        },
        values)};
  if (function == "forward_dynamics")
    return {contender(
        "KDL, ChainFdSolver_RNE", n,
        [e](std::size_t i) {
          e->forward.CartToJnt(e->r[i], e->r_dot[i], e->tau[i], e->no_wrenches, e->result);
        },
        values)};
  if (function == "mass_matrix")
    return {contender(
        "KDL, ChainDynParam", n, [e](std::size_t i) { e->parameters.JntToMass(e->r[i], e->M); },
        [e](std::size_t) {
          return std::vector<double>(e->M.data.data(), e->M.data.data() + e->M.data.size());
        })};
  return {};
}

}  // namespace anholon::bench
