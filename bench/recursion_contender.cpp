// SPDX-License-Identifier: GPL-2.0-or-later
#include <memory>

#include "anholon/articulated.hpp"
#include "contenders.hpp"

namespace anholon::bench {
namespace {

struct Numeric {
  explicit Numeric(const Robot& r)
      : robot(r), tree(r.mechanism), zeros(static_cast<std::size_t>(r.mechanism.coordinates), 0.0) {}
  const Robot& robot;
  RigidTree<double> tree;
  std::vector<double> zeros, values;

  /// Velocities, and the reference body's acceleration minus gravity.
  void move(const Sample& s, const Spatial<double>& eta_dot, bool gravity,
            const std::vector<double>& r_ddot) {
    const Spatial<double>& eta = s.state.eta;
    tree.position(s.state.r);
    tree.move_base(eta.angular, eta_dot.angular, gravity ? eta_dot.linear + drift(s) : Vec3<double>{});
    tree.move(s.state.r_dot, r_ddot);
  }
  [[nodiscard]] Vec3<double> drift(const Sample& s) const {
    return cross(s.state.eta.angular, s.state.eta.linear) -
           transposed_times(s.state.R, robot.mechanism.gravity);
  }
  void keep(const Spatial<double>& base, const std::vector<double>& joints) {
    values.clear();
    for (const int c : free_components(robot.mechanism.group)) values.push_back(base[c]);
    values.insert(values.end(), joints.begin(), joints.end());
  }

  void inverse(std::size_t i) {
    const Sample& s = robot.samples[i];
    move(s, s.eta_dot, true, s.r_ddot);
    Spatial<double> base;
    const std::vector<double> force = tree.inverse_dynamics(base);
    keep(base, force);
  }
  /// A free base's acceleration minus gravity is an unknown.
  void forward(std::size_t i) {
    const Sample& s = robot.samples[i];
    const bool is_free = robot.mechanism.group == GroupKind::SE3;
    move(s, {}, !is_free, zeros);
    TreeAcceleration<double> a = articulated_acceleration(tree, s.tau);
    if (is_free) a.base.linear -= drift(s);
    keep(a.base, a.r_ddot);
  }
  void mass_matrix(std::size_t i) {
    tree.position(robot.samples[i].state.r);
    values = composite_mass_matrix(tree).entries();
  }
};

}  // namespace

std::vector<Contender> recursion_contenders(const Robot& robot, const std::string& function) {
  const auto numeric = std::make_shared<Numeric>(robot);
  const auto call = function == "inverse_dynamics"   ? &Numeric::inverse
                    : function == "forward_dynamics" ? &Numeric::forward
                    : function == "mass_matrix"      ? &Numeric::mass_matrix
                                                     : nullptr;
  if (call == nullptr) return {};
  return {contender(
      "recursion in double", robot.samples.size(),
      [numeric, call](std::size_t i) { (numeric.get()->*call)(i); },
      [numeric](std::size_t) { return numeric->values; })};
}

}  // namespace anholon::bench
