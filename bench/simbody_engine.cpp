// SPDX-License-Identifier: GPL-2.0-or-later
#include "simbody_engine.hpp"

#include <Simbody.h>

namespace anholon::bench {
namespace {

SimTK::Vec3 vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }
SimTK::Vector vector(const std::vector<double>& v) { return {static_cast<int>(v.size()), v.data()}; }
SimTK::Transform pose(const SimbodyBody& b) {
  const SimTK::Mat33 R(b.R[0], b.R[1], b.R[2], b.R[3], b.R[4], b.R[5], b.R[6], b.R[7], b.R[8]);
  return {SimTK::Rotation(R, true), vector(b.p)};  // R as it stands
}

}  // namespace

struct SimbodyEngine::Parts {
  struct Weight {
    SimTK::MobilizedBodyIndex body;
    SimTK::Vec3 centre, force;
  };
  struct Row {
    SimTK::Vector position, velocity, acceleration, force;
  };

  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem applied{system};
  SimTK::State state;
  std::vector<SimTK::MobilizedBody> bodies;
  std::vector<Weight> weights;
  std::vector<Row> rows;
  SimTK::Vector_<SimTK::SpatialVec> forces, accelerations;
  SimTK::Vector result;
  SimTK::Matrix M;

  /// Pins turn about z and sliders move along x of frames that are fixed to both bodies.
  SimTK::MobilizedBody add(const SimbodyBody& b) {
    using Joint = SimbodyBody::Joint;
    SimTK::MobilizedBody ground = matter.updGround();
    if (b.joint == Joint::ground) return ground;
    const auto& I = b.inertia;
    const SimTK::Body::Rigid body(
        SimTK::MassProperties(b.mass, vector(b.centre), SimTK::Inertia(I[0], I[1], I[2], I[3], I[4], I[5])));
    const SimTK::Transform here;
    if (b.joint == Joint::free) return SimTK::MobilizedBody::Free(ground, here, body, here);
    SimTK::MobilizedBody& parent = b.parent < 0 ? ground : bodies[static_cast<std::size_t>(b.parent)];
    if (b.joint == Joint::weld) return SimTK::MobilizedBody::Weld(parent, pose(b), body, here);
    const bool turns = b.joint == Joint::pin;
    const SimTK::CoordinateAxis own =
        turns ? SimTK::CoordinateAxis(SimTK::ZAxis) : SimTK::CoordinateAxis(SimTK::XAxis);
    const SimTK::Transform axis(SimTK::Rotation(SimTK::UnitVec3(vector(b.axis)), own));
    if (turns) return SimTK::MobilizedBody::Pin(parent, pose(b) * axis, body, axis);
    return SimTK::MobilizedBody::Slider(parent, pose(b) * axis, body, axis);
  }
  void move(std::size_t i, SimTK::Stage stage) {
    state.updQ() = rows[i].position;
    state.updU() = rows[i].velocity;
    system.realize(state, stage);
  }
  /// Weights, body by body, as Simbody's own Force::Gravity applies them.
  void weigh() {
    forces.resize(matter.getNumBodies());
    forces = SimTK::SpatialVec(SimTK::Vec3(0), SimTK::Vec3(0));
    for (const Weight& w : weights) matter.addInStationForce(state, w.body, w.centre, w.force, forces);
  }
};

SimbodyEngine::SimbodyEngine(const std::vector<SimbodyBody>& bodies, const std::array<double, 3>& gravity)
    : parts_(std::make_unique<Parts>()) {
  for (const SimbodyBody& b : bodies) {
    parts_->bodies.push_back(parts_->add(b));
    if (b.joint == SimbodyBody::Joint::ground) continue;
    parts_->weights.push_back(
        {parts_->bodies.back().getMobilizedBodyIndex(), vector(b.centre), b.mass * vector(gravity)});
  }
  SimTK::Force::Gravity(parts_->applied, parts_->matter, vector(gravity));
  parts_->state = parts_->system.realizeTopology();
  parts_->system.realizeModel(parts_->state);
}
SimbodyEngine::~SimbodyEngine() = default;

std::size_t SimbodyEngine::first_position(std::size_t body) const {
  return static_cast<std::size_t>(static_cast<int>(parts_->bodies[body].getFirstQIndex(parts_->state)));
}
std::size_t SimbodyEngine::first_velocity(std::size_t body) const {
  return static_cast<std::size_t>(static_cast<int>(parts_->bodies[body].getFirstUIndex(parts_->state)));
}
std::size_t SimbodyEngine::positions() const { return static_cast<std::size_t>(parts_->state.getNQ()); }

void SimbodyEngine::add(const std::vector<double>& position, const std::vector<double>& velocity,
                        const std::vector<double>& acceleration, const std::vector<double>& force) {
  parts_->rows.push_back({vector(position), vector(velocity), vector(acceleration), vector(force)});
}

void SimbodyEngine::inverse_dynamics(std::size_t state) {
  Parts& p = *parts_;
  p.move(state, SimTK::Stage::Velocity);
  p.weigh();
  p.matter.calcResidualForceIgnoringConstraints(p.state, SimTK::Vector(), p.forces,
                                                p.rows[state].acceleration, p.result);
}
void SimbodyEngine::forward_dynamics(std::size_t state) {
  Parts& p = *parts_;
  p.move(state, SimTK::Stage::Dynamics);
  p.weigh();
  p.matter.calcAccelerationIgnoringConstraints(p.state, p.rows[state].force, p.forces, p.result,
                                               p.accelerations);
}
void SimbodyEngine::mass_matrix(std::size_t state) {
  parts_->move(state, SimTK::Stage::Position);
  parts_->matter.calcM(parts_->state, parts_->M);
}

long SimbodyEngine::fall(std::size_t state, double duration, double accuracy, std::vector<double>& position,
                         std::vector<double>& velocity) {
  Parts& p = *parts_;
  p.move(state, SimTK::Stage::Velocity);
  SimTK::RungeKuttaMersonIntegrator integrator(p.system);
  integrator.setAccuracy(accuracy);
  SimTK::TimeStepper stepper(p.system, integrator);
  stepper.initialize(p.state);
  stepper.stepTo(duration);
  const SimTK::State& end = integrator.getState();
  position.resize(static_cast<std::size_t>(end.getNQ()));
  velocity.resize(static_cast<std::size_t>(end.getNU()));
  for (std::size_t i = 0; i < position.size(); ++i) position[i] = end.getQ()[static_cast<int>(i)];
  for (std::size_t i = 0; i < velocity.size(); ++i) velocity[i] = end.getU()[static_cast<int>(i)];
  return integrator.getNumRealizations();
}

double SimbodyEngine::result(std::size_t i) const { return parts_->result[static_cast<int>(i)]; }
double SimbodyEngine::entry(std::size_t i, std::size_t j) const {
  return parts_->M(static_cast<int>(i), static_cast<int>(j));
}

}  // namespace anholon::bench
