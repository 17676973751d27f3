// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/recursion_dynamics.hpp"

#include "describe/mechanise.hpp"
#include "simulate/numeric_reduction.hpp"

namespace anholon {
namespace {

Mechanism<double> mechanism_of(const Model& model) {
  std::vector<double> parameters;
  for (const Parameter& p : model.parameters) parameters.push_back(p.value.to_double());
  return mechanise<double>(describe_mechanism(model), parameters);
}

}  // namespace

RecursionDynamics::RecursionDynamics(const SceneProgram& program, Runner<double>& run)
    : program_(program),
      run_(run),
      mechanism_(mechanism_of(program.model)),
      dynamics_(mechanism_),
      shape_(run.size() - static_cast<Eigen::Index>(run.b.nu.size())),
      passive_(static_cast<Eigen::Index>(program.reduced.passive.size())),
      reduced_y_(Eigen::VectorXd::Zero(run.size())) {}

Eigen::VectorXd RecursionDynamics::velocities_of_buffers() const {
  Eigen::VectorXd v(passive_);
  Eigen::Index next = 0;
  for (const auto* part : {&run_.b.eta, &run_.b.r_p_dot, &run_.b.r_d_dot}) {
    for (const double x : *part) v(next++) = x;
  }
  return v;
}

void RecursionDynamics::set_velocity(Eigen::Index passive, double rate) {
  const int n = program_.reduced.n, s_p = program_.original.s_p();
  if (passive < n) {
    run_.b.eta[static_cast<std::size_t>(passive)] = rate;
  } else if (passive < n + s_p) {
    run_.b.r_p_dot[static_cast<std::size_t>(passive - n)] = rate;
  } else {
    run_.b.r_d_dot[static_cast<std::size_t>(passive - n - s_p)] = rate;
  }
}

void RecursionDynamics::rates(State<double>& s, const Eigen::VectorXd& y, Eigen::VectorXd& y_dot) {
  const Partition& p = program_.reduced;
  const auto components = free_components(program_.model.group);
  s.r.assign(program_.model.coordinates.size(), 0), s.r_dot = s.r;
  for (std::size_t i = 0; i < p.passive.size(); ++i) {
    const double rate = y(shape_ + static_cast<Eigen::Index>(i));
    const int velocity = p.passive[i];
    if (velocity < p.n) {
      s.eta[components[static_cast<std::size_t>(velocity)]] = rate;
    } else {
      s.r[static_cast<std::size_t>(velocity - p.n)] = y(static_cast<Eigen::Index>(i) - p.n);
      s.r_dot[static_cast<std::size_t>(velocity - p.n)] = rate;
      y_dot(static_cast<Eigen::Index>(i) - p.n) = rate;
    }
  }
  DynamicVector<double> active(static_cast<Eigen::Index>(p.active.size()));
  for (std::size_t i = 0; i < p.active.size(); ++i) {
    s.r[static_cast<std::size_t>(p.active[i] - p.n)] = run_.b.r_m[i];
    s.r_dot[static_cast<std::size_t>(p.active[i] - p.n)] = run_.b.r_m_dot[i];
    active(static_cast<Eigen::Index>(i)) = run_.b.r_m_ddot[i];
  }

  DynamicVector<double> torques = DynamicVector<double>::Zero(velocity_size(mechanism_));
  for (std::size_t i = 0; i < program_.driven.size(); ++i) torques(program_.driven[i]) = run_.b.torque[i];
  y_dot.tail(passive_) = passive_accelerations(dynamics_, s, p, active, torques);
}

}  // namespace anholon
