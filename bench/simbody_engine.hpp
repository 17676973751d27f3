// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// A tree of bodies in Simbody, behind an interface of plain numbers: its headers are C++17, which C++20
// refuses.

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace anholon::bench {

/// A body and the joint that carries it; matrices are row-major.
struct SimbodyBody {
  enum class Joint { ground, free, weld, pin, slider };
  int parent = -1;  // an earlier body, or the ground
  Joint joint = Joint::weld;
  std::array<double, 3> axis = {0, 0, 1};                 // of pin or slider, in the body's frame
  std::array<double, 9> R = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // pose in the parent's frame, at zero displacement
  std::array<double, 3> p = {0, 0, 0};
  double mass = 0;
  std::array<double, 3> centre = {0, 0, 0};
  std::array<double, 6> inertia = {0, 0, 0, 0, 0, 0};  // xx yy zz xy xz yz about the origin
};

class SimbodyEngine {
 public:
  SimbodyEngine(const std::vector<SimbodyBody>& bodies, const std::array<double, 3>& gravity);
  ~SimbodyEngine();
  SimbodyEngine(const SimbodyEngine&) = delete;
  SimbodyEngine& operator=(const SimbodyEngine&) = delete;

  /// Where a body's joint begins in Simbody's positions and in its velocities.
  [[nodiscard]] std::size_t first_position(std::size_t body) const;
  [[nodiscard]] std::size_t first_velocity(std::size_t body) const;
  [[nodiscard]] std::size_t positions() const;

  /// A state, in Simbody's order and axes.
  void add(const std::vector<double>& position, const std::vector<double>& velocity,
           const std::vector<double>& acceleration, const std::vector<double>& force);
  void inverse_dynamics(std::size_t state);
  void forward_dynamics(std::size_t state);
  void mass_matrix(std::size_t state);
  /// Lets the system fall from a state, without joint forces, by Runge-Kutta-Merson with error control.
  /// @param position, velocity  out: at the end, in Simbody's order
  /// @return evaluations of the dynamics
  long fall(std::size_t state, double duration, double accuracy, std::vector<double>& position,
            std::vector<double>& velocity);
  /// Of the last inverse_dynamics() or forward_dynamics().
  [[nodiscard]] double result(std::size_t i) const;
  /// Of the last mass_matrix().
  [[nodiscard]] double entry(std::size_t i, std::size_t j) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace anholon::bench
