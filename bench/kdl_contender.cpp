// SPDX-License-Identifier: GPL-2.0-or-later
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
        no_wrenches(chain.getNrOfSegments(), KDL::Wrench::Zero()),
        result(chain.getNrOfJoints()) {
    for (const Sample& s : robot.samples) {
      r.push_back(array(s.state.r));
      r_dot.push_back(array(s.state.r_dot));
      r_ddot.push_back(array(s.r_ddot));
      tau.push_back(array(s.tau));
    }
  }
  void run_inverse(std::size_t i) { inverse.CartToJnt(r[i], r_dot[i], r_ddot[i], no_wrenches, result); }
  void run_forward(std::size_t i) { forward.CartToJnt(r[i], r_dot[i], tau[i], no_wrenches, result); }
  [[nodiscard]] std::vector<double> values() const {
    return {result.data.data(), result.data.data() + result.data.size()};
  }

  KDL::Chain chain;
  KDL::Vector gravity;
  KDL::ChainIdSolver_RNE inverse;
  KDL::ChainFdSolver_RNE forward;
  KDL::Wrenches no_wrenches;
  KDL::JntArray result;
  std::vector<KDL::JntArray> r, r_dot, r_ddot, tau;
};

}  // namespace

std::vector<Contender> kdl_contenders(const Robot& robot, const std::string& function) {
  if (robot.mechanism.group != GroupKind::fixed || !testing::is_chain(robot.mechanism)) return {};
  if (function != "inverse_dynamics" && function != "forward_dynamics") return {};
  const auto engine = std::make_shared<Engine>(robot);
  const auto call = function == "inverse_dynamics" ? &Engine::run_inverse : &Engine::run_forward;
  return {{"KDL, " + std::string(function == "inverse_dynamics" ? "ChainIdSolver_RNE" : "ChainFdSolver_RNE"),
           [engine, call] {
             for (std::size_t i = 0; i < engine->r.size(); ++i) (engine.get()->*call)(i);
           },
           [engine, call](std::size_t i) {
             (engine.get()->*call)(i);
             return engine->values();
           }}};
}

}  // namespace anholon::bench
