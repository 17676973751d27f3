// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/motion_sizes.hpp"

#include <algorithm>
#include <cmath>

namespace anholon {
namespace {

constexpr double least_share = 1e-3;  // of the largest of its kind

/// Applies the floor to the sizes of one kind.
void raise(const std::vector<double*>& kind) {
  double largest = 0;
  for (const double* size : kind) largest = std::max(largest, *size);
  if (largest == 0) largest = 1 / least_share;  // all of them: 1
  for (double* size : kind) *size = std::max(*size, least_share * largest);
}

void widen(std::vector<double>& sizes, const std::vector<double>& values, std::size_t at = 0) {
  for (std::size_t i = 0; i < values.size(); ++i)
    sizes[at + i] = std::max(sizes[at + i], std::abs(values[i]));
}

/// Whether each entry of (shape) or (eta, shape rates) is an angle: passive coordinates, then torque-driven
/// ones.
std::vector<char> angles_of_shape(const SceneProgram& program) {
  std::vector<char> angles;
  const auto add = [&](int velocity) {
    if (velocity >= program.original.n)
      angles.push_back(
          program.model.coordinates[static_cast<std::size_t>(velocity - program.original.n)].is_angle);
  };
  for (const int i : program.original.passive) add(i);
  for (const int i : program.driven) add(i);
  if (program.projects_motion) {
    for (const int i : program.reduced.active) add(i);
  }
  return angles;
}

}  // namespace

double spectral_radius(const Eigen::MatrixXd& J) {
  constexpr int squarings = 8;
  Eigen::MatrixXd power = J;
  double logarithm = 0;  // of what has been divided off, per power of J
  for (int i = 0; i <= squarings; ++i) {
    const double size = power.norm(), share = std::ldexp(1.0, -i);
    if (!(size > 0)) return 0;
    logarithm += share * std::log(size);
    if (i == squarings) break;
    power /= size;
    power = (power * power).eval();
  }
  return std::exp(logarithm);
}

std::vector<double> MotionSizes::of_state() const {
  std::vector<double> y = shape;
  y.insert(y.end(), nu.begin(), nu.end());
  y.insert(y.end(), 2, energy);
  return y;
}

std::vector<double> MotionSizes::of_velocity_state() const {
  std::vector<double> y = shape;
  y.insert(y.end(), velocities.begin(), velocities.end());
  return y;
}

MotionSizes::MotionSizes(const SceneProgram& program, const Runner<double>& run)
    : shape(run.b.r_p.size() + run.carried_coordinates().size(), 1),
      nu(run.b.nu.size(), 1),
      velocities(program.reduced.passive.size(), 1) {}

integrate::AdaptiveOptions<double> relative_tolerance(double tolerance, const MotionSizes& sizes,
                                                      std::span<const double> y) {
  integrate::AdaptiveOptions<double> options;
  options.rtol = options.atol = tolerance;
  options.angle = sizes.angle;
  options.length = sizes.length;
  options.sizes = y;
  return options;
}

MotionSizesCollector::MotionSizesCollector(const SceneProgram& program, Runner<double>& run)
    : program_(program), run_(run), seen_(program, run) {
  seen_.angle = seen_.length = seen_.energy = 0;
  for (auto* kind : {&seen_.shape, &seen_.nu, &seen_.velocities}) std::ranges::fill(*kind, 0);
}

void MotionSizesCollector::observe(double turn, double displacement, double work, double dissipated) {
  if (run_.rates) run_.rates();
  if (run_.energies) run_.energies();
  const Buffers<double>& b = run_.b;
  seen_.angle = std::max(seen_.angle, std::min(turn, 1.0));
  seen_.length = std::max(seen_.length, displacement);
  widen(seen_.shape, b.r_p);
  widen(seen_.shape, run_.carried_coordinates(), b.r_p.size());
  widen(seen_.nu, b.nu);
  widen(seen_.velocities, b.eta);
  widen(seen_.velocities, b.r_p_dot, b.eta.size());
  widen(seen_.velocities, b.r_d_dot, b.eta.size() + b.r_p_dot.size());
  energy_.observe(b.kinetic[0], b.gravity[0] + b.elastic[0], work, dissipated);
}

MotionSizes MotionSizesCollector::sizes() const {
  MotionSizes sizes = seen_;
  std::vector<double*> angles = {&sizes.angle}, lengths = {&sizes.length}, nu, velocities;
  const std::vector<char> is_angle = angles_of_shape(program_);
  for (std::size_t i = 0; i < sizes.shape.size(); ++i)
    (is_angle[i] != 0 ? angles : lengths).push_back(&sizes.shape[i]);
  for (double& x : sizes.nu) nu.push_back(&x);
  for (double& x : sizes.velocities) velocities.push_back(&x);
  for (const auto& kind : {angles, lengths, nu, velocities}) raise(kind);
  sizes.energy = energy_.scale() > 0 ? energy_.scale() : 1;
  return sizes;
}

bool overestimated(const MotionSizes& used, const MotionSizes& seen) {
  constexpr double much = 10;
  const std::vector<double> before = used.of_state(), after = seen.of_state();
  if (used.angle > much * seen.angle || used.length > much * seen.length) return true;
  for (std::size_t i = 0; i < after.size(); ++i) {
    if (before[i] > much * after[i]) return true;
  }
  return false;
}

}  // namespace anholon
