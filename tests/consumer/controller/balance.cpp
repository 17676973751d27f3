// SPDX-License-Identifier: MIT
//
// A 1 kHz control loop keeps a bicycle upright by steer for ten seconds, at constant speed, through two
// pushes. The controller calls generated code for the torques that its motors need; the bicycle itself is the
// generated forward dynamics, integrated by Runge-Kutta-Munthe-Kaas on SE(3). Nothing allocates in the loop.
//
// Exit status: 0 if the bicycle stands still upright at the end, falls without control, and nothing was
// allocated.

// Eigen allocates by malloc: its own check stands in for a count.
#include <cstdlib>
#define EIGEN_RUNTIME_NO_MALLOC
#define eigen_assert(condition)     \
  do {                              \
    if (!(condition)) std::abort(); \
  } while (false)

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <new>
#include <vector>

#include "anholon/integrate/rkmk.hpp"
#include "anholon/lie/se3.hpp"
#include "bicycle.hpp"

namespace {
long allocations = 0;
}
// Not inlined: the compiler would take the inner malloc and free for a mismatch with new and delete.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace {

namespace model = bicycle::standard;
using Prepared = model::Prepared<double>;
using SE3 = anholon::lie::SE3<double>;
using Stages = anholon::integrate::Rkmk4<SE3>;
using Vector = Stages::Vector;

constexpr double dt = 1e-3;       // [s]
constexpr double duration = 10;   // [s]
constexpr double rear_spin = 12;  // r3_dot [rad/s]: 3.96 m/s

/// What the sensors of the bicycle give.
struct Measured {
  double R[9];          // R_WB, row-major
  double r_p[1];        // r2
  double r_a[2];        // r1 steer, r3 rear wheel
  double roll_rate[1];  // nu = Omega_Y
  double r_a_dot[2];

  /// Lean to the right [rad]: Omega_Y lifts Z, the left.
  double roll() const { return std::atan2(R[8], R[6]); }
};

struct Command {
  double r_a_ddot[2];  // of steer and rear wheel
  double tau_a[2];     // torques of their motors [N m]
};

/// State feedback from roll and steer to the second derivative of the steer.
///
/// Generated code linearised about upright, straight on at 12 rad/s of the rear wheel, x = roll - balance:
///
///   x_ddot = 23.24 x + 38.05 r1 + 5.195 r1_dot + 0.01185 r1_ddot
///
/// Gains put the four poles to -5, -6, -7, -8 rad/s (Ackermann's formula). Steer goes into the fall.
class Controller {
 public:
  explicit Controller(const model::Parameters<double>& parameters, double gain = 1)
      : par_(model::prepare(parameters)), balance_(std::atan2(parameters.mZ0, parameters.mX0)), gain_(gain) {}

  /// Roll with the centre of mass above the line of contacts.
  double balance() const { return balance_; }

  Command step(const Measured& now) const {
    const double x = now.roll() - balance_;
    Command command;
    command.r_a_ddot[0] =
        -gain_ * (127.13 * x + 26.35 * now.roll_rate[0]) - 135.85 * now.r_a[0] - 25.69 * now.r_a_dot[0];
    command.r_a_ddot[1] = 0;  // constant speed
    double nu_dot[1], eta_dot[6], r_p_ddot[1];
    model::forward_dynamics(par_, now.R, now.r_p, now.r_a, now.roll_rate, now.r_a_dot, command.r_a_ddot,
                            nu_dot, eta_dot, r_p_ddot);
    model::inverse_torques(par_, now.R, now.r_p, now.r_a, now.roll_rate, now.r_a_dot, command.r_a_ddot,
                           nu_dot, command.tau_a);
    return command;
  }

 private:
  Prepared par_;
  double balance_;
  double gain_;
};

/// The bicycle: g in SE(3) and y = (r2, Omega_Y, r1, r3, r1_dot, r3_dot).
class Bicycle {
 public:
  /// Upright (X up) and heading along world Y, leaning by `roll`.
  Bicycle(const model::Parameters<double>& parameters, double roll)
      : par_(model::prepare(parameters)), stages_(6) {
    const double quarter = std::acos(-1.0) / 2;
    SE3::Tangent lean;  // about Y, from the pose with Z up
    lean << 0, 0, 0, 0, roll - quarter, 0;
    state_.g = SE3(SE3::exp(lean).rotation(), SE3::Vector3(0, 0, parameters.h));
    state_.y = Vector::Zero(6);
    state_.y[5] = rear_spin;
  }

  Measured measure() const {
    Measured now;
    copy_R(state_.g, now.R);
    const Vector& y = state_.y;
    now.r_p[0] = y[0], now.roll_rate[0] = y[1];
    now.r_a[0] = y[2], now.r_a[1] = y[3], now.r_a_dot[0] = y[4], now.r_a_dot[1] = y[5];
    return now;
  }

  void push(double roll_rate) { state_.y[1] += roll_rate; }

  /// One step of dt with the commanded accelerations held.
  bool advance(const Command& command, double t) {
    const auto field = [&](double, const SE3& g, const Vector& y, SE3::Tangent& eta, Vector& y_dot) {
      double R[9];
      copy_R(g, R);
      const double r_p[1] = {y[0]}, nu[1] = {y[1]}, r_a[2] = {y[2], y[3]}, r_a_dot[2] = {y[4], y[5]};
      double twist[6], r_p_dot[1], H[7], J[14], nu_dot[1], eta_dot[6], r_p_ddot[1];
      model::kinematics(par_, r_a, nu, r_a_dot, twist, r_p_dot, H, J);
      model::forward_dynamics(par_, R, r_p, r_a, nu, r_a_dot, command.r_a_ddot, nu_dot, eta_dot, r_p_ddot);
      for (int i = 0; i < 6; ++i) eta[i] = twist[i];
      y_dot << r_p_dot[0], nu_dot[0], r_a_dot[0], r_a_dot[1], command.r_a_ddot[0], command.r_a_ddot[1];
    };
    return static_cast<bool>(anholon::integrate::integrate_fixed(stages_, field, state_, t, 1));
  }

 private:
  static void copy_R(const SE3& g, double (&entries)[9]) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{entries} = g.R();
  }

  Prepared par_;
  Stages stages_;
  anholon::integrate::State<SE3> state_;
};

double microseconds(std::chrono::steady_clock::duration d) {
  return std::chrono::duration<double, std::micro>(d).count();
}

void print_times(const char* what, std::vector<double>& times) {
  std::sort(times.begin(), times.end());
  std::printf("  %s  median %.2f us, 99 %% below %.2f us, worst step %.2f us\n", what,
              times[times.size() / 2], times[times.size() * 99 / 100], times.back());
}

/// When the bicycle lies on its side without feedback on roll [s].
double fall_time(const model::Parameters<double>& parameters, double roll) {
  const Controller controller(parameters, 0);
  Bicycle bicycle(parameters, roll);
  for (int i = 0; i < 10000; ++i) {
    const Measured now = bicycle.measure();
    if (std::abs(now.roll()) > 1) return i * dt;
    if (!bicycle.advance(controller.step(now), (i + 1) * dt)) break;
  }
  return duration;
}

}  // namespace

int main() {
  using Clock = std::chrono::steady_clock;
  const model::Parameters<double> parameters;
  const Controller controller(parameters);
  const double roll_0 = controller.balance() + 0.15;
  const double falls_after = fall_time(parameters, roll_0);

  Bicycle bicycle(parameters, roll_0);
  double largest_lean = 0, largest_steer = 0, largest_torque = 0;
  bool finite = true;
  constexpr int steps = 10000;
  static_assert(steps * dt == duration);
  std::vector<double> control_times(steps), step_times(steps);
  const long allocations_before = allocations;
  Eigen::internal::set_is_malloc_allowed(false);
  for (int i = 0; i < steps && finite; ++i) {
    if (i == 3000) bicycle.push(0.5);
    if (i == 6000) bicycle.push(-0.8);
    const auto begin = Clock::now();
    const Measured now = bicycle.measure();
    const Command command = controller.step(now);
    const auto controlled = Clock::now();
    finite = bicycle.advance(command, (i + 1) * dt);
    const auto end = Clock::now();
    largest_lean = std::max(largest_lean, std::abs(now.roll() - controller.balance()));
    largest_steer = std::max(largest_steer, std::abs(now.r_a[0]));
    largest_torque = std::max(largest_torque, std::abs(command.tau_a[0]));
    control_times[static_cast<std::size_t>(i)] = microseconds(controlled - begin);
    step_times[static_cast<std::size_t>(i)] = microseconds(end - begin);
  }
  Eigen::internal::set_is_malloc_allowed(true);
  const long allocated = allocations - allocations_before;
  const double last = std::abs(bicycle.measure().roll() - controller.balance());

  std::printf("without control the bicycle lies down after %.2f s\n", falls_after);
  std::printf("with control, %d steps of 1 ms:\n", steps);
  std::printf("  largest lean, steer      %.3f rad, %.3f rad\n", largest_lean, largest_steer);
  std::printf("  lean at the end          %.1e rad\n", last);
  std::printf("  largest steering torque  %.2f N m\n", largest_torque);
  std::printf("  allocations              %ld\n", allocated);
  print_times("control step           ", control_times);
  print_times("with the bicycle's step", step_times);
  const bool stands = finite && largest_lean < 0.5 && last < 1e-6;
  const bool passed = stands && falls_after < 2 && allocated == 0;
  std::printf("%s\n", passed ? "upright" : "FAILED");
  return passed ? 0 : 1;
}
