// SPDX-License-Identifier: GPL-2.0-or-later
#include <memory>

#include "anholon/articulated.hpp"
#include "contenders.hpp"

namespace anholon::bench {
namespace {

struct Numeric {
  explicit Numeric(const Robot& r) : robot(r), tree(r.mechanism) {}
  const Robot& robot;
  RigidTree<double> tree;
  std::vector<double> values;

  void inverse(std::size_t i) {
    const Sample& s = robot.samples[i];
    const Spatial<double>& eta = s.state.eta;
    tree.position(s.state.r);
    tree.move_base(eta.angular, s.eta_dot.angular,
                   s.eta_dot.linear + cross(eta.angular, eta.linear) -
                       transposed_times(s.state.R, robot.mechanism.gravity));
    tree.move(s.state.r_dot, s.r_ddot);
    Spatial<double> base;
    const std::vector<double> force = tree.inverse_dynamics(base);
    values.clear();
    for (const int c : free_components(robot.mechanism.group)) values.push_back(base[c]);
    values.insert(values.end(), force.begin(), force.end());
  }
};

}  // namespace

std::vector<Contender> recursion_contenders(const Robot& robot, const std::string& function) {
  auto numeric = std::make_shared<Numeric>(robot);
  if (function == "inverse_dynamics")
    return {{"recursion in double",
             [numeric] {
               for (std::size_t i = 0; i < numeric->robot.samples.size(); ++i) numeric->inverse(i);
             },
             [numeric](std::size_t i) {
               numeric->inverse(i);
               return numeric->values;
             }}};
  return {};
}

}  // namespace anholon::bench
