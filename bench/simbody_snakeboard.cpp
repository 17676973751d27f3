// SPDX-License-Identifier: GPL-2.0-or-later
#include "simbody_snakeboard.hpp"

#include <Simbody.h>

#include "simulate/cpu_time.hpp"

namespace anholon::bench {

SnakeboardEnd simbody_snakeboard(const SnakeboardFigures& f, double duration, double accuracy) {
  using SimTK::Vec3;
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter(system);
  const SimTK::Transform origin;
  // The motion is plane, so that only inertias about Z count; the others are what a flat body has. The rotor
  // has no mass of its own in the model, and Simbody refuses inertia without mass: it gets some of the
  // platform's, whose centre is on the rotor's axis.
  const auto flat = [](double mass, double J) {
    return SimTK::Body::Rigid(SimTK::MassProperties(mass, Vec3(0), SimTK::Inertia(J / 2, J / 2, J)));
  };
  const double rotor_mass = f.m_p / 4;
  SimTK::MobilizedBody::Planar platform(matter.Ground(), origin, flat(f.m_p - rotor_mass, f.J_p), origin);
  SimTK::MobilizedBody::Pin rear(platform, SimTK::Transform(Vec3(-f.l, 0, 0)), flat(f.m_a, f.J_a), origin);
  SimTK::MobilizedBody::Pin front(platform, SimTK::Transform(Vec3(f.l, 0, 0)), flat(f.m_a, f.J_a), origin);
  SimTK::MobilizedBody::Pin rotor(platform, origin, flat(rotor_mass, f.J_r + f.J_h), origin);
  constexpr double rate = 2.5;
  const SimTK::Motion::Sinusoid steer_rear(rear, SimTK::Motion::Position, 0.5, rate, 0);
  const SimTK::Motion::Sinusoid steer_front(front, SimTK::Motion::Position, -0.5, rate, 0);
  const SimTK::Motion::Sinusoid turn_rotor(rotor, SimTK::Motion::Position, 0.7, rate, SimTK::Pi / 2);
  const SimTK::UnitVec3 lateral(SimTK::YAxis);
  const SimTK::Constraint::NoSlip1D rear_wheels(rear, Vec3(0), lateral, matter.updGround(), platform);
  const SimTK::Constraint::NoSlip1D front_wheels(front, Vec3(0), lateral, matter.updGround(), platform);

  SimTK::State state = system.realizeTopology();
  system.realizeModel(state);
  platform.setOneU(state, 1, 0.5);
  const double start = cpu_now();
  SimTK::RungeKuttaMersonIntegrator integrator(system);
  integrator.setAccuracy(accuracy);
  SimTK::TimeStepper stepper(system, integrator);
  stepper.initialize(state);
  stepper.stepTo(duration);
  const double spent = cpu_now() - start;

  const SimTK::State& last = integrator.getState();
  SnakeboardEnd end;
  end.cpu_seconds = spent;
  end.theta = platform.getOneQ(last, 0), end.x = platform.getOneQ(last, 1), end.y = platform.getOneQ(last, 2);
  const double x_dot = platform.getOneU(last, 1), y_dot = platform.getOneU(last, 2);
  end.Omega_Z = platform.getOneU(last, 0);
  end.V_X = std::cos(end.theta) * x_dot + std::sin(end.theta) * y_dot;
  end.V_Y = std::cos(end.theta) * y_dot - std::sin(end.theta) * x_dot;
  end.evaluations = integrator.getNumRealizations();
  return end;
}

}  // namespace anholon::bench
