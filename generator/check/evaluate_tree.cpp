// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/evaluate_tree.hpp"

namespace anholon {

const std::vector<std::string>& functions_of_evaluation() {
  static const std::vector<std::string> names = {"inverse_dynamics", "bias_forces",    "mass_matrix",
                                                 "forward_dynamics", "imposed_motion", "energies"};
  return names;
}

Evaluated<double> evaluate_tree(const Mechanism<double>& mechanism, const ProgramCaller<double>& call,
                                const EvaluationInput<double>& input, const TreePoint<double>& point) {
  const NamedValues<double> in = tree_inputs(mechanism, point);
  const auto n = free_components(mechanism.group).size();
  const int size = static_cast<int>(n) + mechanism.coordinates;
  const auto join = [](const NamedValues<double>& blocks, const std::string& base,
                       const std::string& joints) {
    std::vector<double> v;
    for (const std::string& name : {base, joints}) {
      if (const auto found = blocks.find(name); found != blocks.end())
        v.insert(v.end(), found->second.begin(), found->second.end());
    }
    return v;
  };
  Evaluated<double> e;
  e.M = Matrix<double>(size, size);
  const NamedValues<double> mass = call("mass_matrix", in);
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) e.M(i, j) = mass.at("M")[static_cast<std::size_t>(i * size + j)];
  }
  e.force = join(call("bias_forces", in), "base_wrench", "tau");
  for (double& x : e.force) x = -x;
  e.G = Matrix<double>(0, size);
  e.projector = Matrix<double>(static_cast<int>(n), static_cast<int>(n));
  for (int i = 0; i < e.projector.rows(); ++i) e.projector(i, i) = 1;
  const NamedValues<double> energies = call("energies", in);
  e.kinetic = energies.at("kinetic")[0], e.gravity = energies.at("gravity")[0],
  e.elastic = energies.at("elastic")[0], e.dissipated_power = energies.at("dissipated_power")[0];
  if (input.has_acceleration) {
    const NamedValues<double> motion = n > 0 ? call("imposed_motion", in) : call("inverse_dynamics", in);
    if (n > 0) e.acceleration = motion.at("eta_dot");
    e.acceleration.insert(e.acceleration.end(), input.r_ddot.begin(), input.r_ddot.end());
    e.tau_a = motion.at("tau");
  }
  if (input.has_torque) e.free_acceleration = join(call("forward_dynamics", in), "eta_dot", "r_ddot");
  return e;
}

}  // namespace anholon
