// SPDX-License-Identifier: MIT
#pragma once

// Where a body hangs on a compliant one: the frame of the station in the frame of the compliant body, its
// velocity and acceleration there, and the modal forces of what pulls on it (design of eq. (70) with the
// elastic transform). The turn is R = exp [theta] with theta = sum_j turn_j r_j, its angular velocity
// J(theta) theta_dot with J = a 1 + b [theta] + c theta theta^T.
//
// Turns that share a coordinate axis take a sine and a cosine. Others take Stumpff's functions
// c_k(s) = sum_i (-s)^i / (k + 2i)! of s = theta . theta: a = c_1, b = c_2, c = c_3. They are entire
// functions of s, so that nothing happens at theta = 0; c_4 and c_5 are summed, the others follow by c_k =
// 1/k! - s c_{k+2}, derivatives by 2 c_k' = k c_{k+2} - c_{k+1}. The sum below is exact to 1e-25 for |theta|
// <= pi, 1e-15 for 2 pi.

#include <span>
#include <vector>

#include "anholon/mechanism.hpp"

namespace anholon {

/// c_1 ... c_5 at index 1 ... 5.
template <class S>
std::array<S, 6> stumpff(const S& s) {
  constexpr int terms = 16;
  std::array<S, 6> c = {S(0), S(0), S(0), S(0), S(0), S(0)};
  for (int k = 4; k <= 5; ++k) {  // Horner: 1/k! (1 - s/((k+1)(k+2)) (1 - s/((k+3)(k+4)) (...)))
    S sum = S(1);
    for (int i = terms; i > 0; --i) sum = S(1) - s * (S(1) / S((k + 2 * i - 1) * (k + 2 * i))) * sum;
    c[static_cast<std::size_t>(k)] = sum / S(k == 4 ? 24 : 120);
  }
  c[3] = S(1) / S(6) - s * c[5];
  c[2] = S(1) / S(2) - s * c[4];
  c[1] = S(1) - s * c[3];
  return c;
}

template <class S>
class StationFrame {
 public:
  /// Places the frame at the shape r (all coordinates of the mechanism).
  void place(const Station<S>& station, std::span<const S> r) {
    using std::cos, std::sin;
    station_ = &station;
    offset_ = station.at;
    theta_ = {};
    slopes_.clear();
    for (const StationMode<S>& mode : station.modes) {
      const S& shape = r[static_cast<std::size_t>(mode.coordinate)];
      Vec3<S> slope = mode.phi;
      for (std::size_t l = 0; l < mode.psi.size(); ++l)
        slope += r[static_cast<std::size_t>(station.modes[l].coordinate)] * mode.psi[l];
      offset_ += shape * (S(1) / S(2)) * (mode.phi + slope);
      theta_ += shape * mode.turn;
      slopes_.push_back(slope);
    }
    if (station.axis >= 0) {
      const S angle = theta_[station.axis];
      rotation_ = {station.axis, cos(angle), sin(angle)};
      return;
    }
    c_ = stumpff(dot(theta_, theta_));
    R_ = c_[2] * outer(theta_, theta_) + c_[1] * skew(theta_);
    const S cosine = S(1) - dot(theta_, theta_) * c_[2];
    for (int i = 0; i < 3; ++i) R_(i, i) = R_(i, i) + cosine;
  }

  /// Origin in the compliant body's frame.
  [[nodiscard]] const Vec3<S>& offset() const { return offset_; }
  /// Components in the compliant body's axes of a vector given in the station's.
  [[nodiscard]] Vec3<S> from(const Vec3<S>& v) const {
    return station_->axis >= 0 ? rotation_.apply(v) : R_ * v;
  }
  /// Components in the station's axes of a vector given in the compliant body's.
  [[nodiscard]] Vec3<S> to(const Vec3<S>& v) const {
    return station_->axis >= 0 ? rotation_.apply_inverse(v) : transposed_times(R_, v);
  }
  [[nodiscard]] Mat3<S> rotation() const { return station_->axis >= 0 ? rotation_.matrix() : R_; }

  /// Velocity of origin and axes as seen from the compliant body, in its axes.
  [[nodiscard]] Spatial<S> velocity(std::span<const S> r_dot) const {
    Spatial<S> v;
    Vec3<S> turning;
    for (std::size_t j = 0; j < slopes_.size(); ++j) {
      const S& rate = r_dot[static_cast<std::size_t>(station_->modes[j].coordinate)];
      v.linear += rate * slopes_[j];
      turning += rate * station_->modes[j].turn;
    }
    v.angular = turned(turning);
    return v;
  }

  /// Acceleration of origin and axes as seen from the compliant body, in its axes.
  [[nodiscard]] Spatial<S> acceleration(std::span<const S> r_dot, std::span<const S> r_ddot) const {
    Spatial<S> a;
    Vec3<S> rate, twice;  // of theta
    const auto of = [this](std::size_t j) { return static_cast<std::size_t>(station_->modes[j].coordinate); };
    for (std::size_t j = 0; j < slopes_.size(); ++j) {
      const StationMode<S>& mode = station_->modes[j];
      rate += r_dot[of(j)] * mode.turn;
      twice += r_ddot[of(j)] * mode.turn;
      a.linear += r_ddot[of(j)] * slopes_[j];
      for (std::size_t l = 0; l < mode.psi.size() && l <= j; ++l) {
        const S product = r_dot[of(j)] * r_dot[of(l)];
        a.linear += (l == j ? product : S(2) * product) * mode.psi[l];
      }
    }
    a.angular = turned(twice);
    if (station_->axis >= 0) return a;
    const S along = dot(theta_, rate);  // J_dot theta_dot, with s_dot = 2 along
    const Vec3<S> across = cross(theta_, rate);
    a.angular += (S(2) * c_[3] - c_[2]) * along * rate;
    a.angular += (S(2) * c_[4] - c_[3]) * along * across;
    a.angular += ((S(3) * c_[5] - c_[4]) * (along * along) + c_[3] * dot(rate, rate)) * theta_;
    return a;
  }

  /// Calls add(coordinate, generalised force) for a wrench on the station's frame, given about its origin in
  /// the compliant body's axes.
  template <class F>
  void modal_forces(const Spatial<S>& wrench, const F& add) const {
    Vec3<S> moment = wrench.angular;
    if (station_->axis < 0) {  // J^T
      moment = c_[1] * wrench.angular - c_[2] * cross(theta_, wrench.angular) +
               c_[3] * dot(theta_, wrench.angular) * theta_;
    }
    for (std::size_t j = 0; j < slopes_.size(); ++j) {
      const S force = dot(wrench.linear, slopes_[j]);
      add(station_->modes[j].coordinate, force + dot(moment, station_->modes[j].turn));
    }
  }

 private:
  static Mat3<S> outer(const Vec3<S>& a, const Vec3<S>& b) {
    Mat3<S> m;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) m(i, j) = a[i] * b[j];
    }
    return m;
  }
  /// J(theta) x
  [[nodiscard]] Vec3<S> turned(const Vec3<S>& x) const {
    if (station_->axis >= 0) return x;
    return c_[1] * x + c_[2] * cross(theta_, x) + c_[3] * dot(theta_, x) * theta_;
  }

  const Station<S>* station_ = nullptr;
  Vec3<S> offset_, theta_;
  std::vector<Vec3<S>> slopes_;  // derivative of the offset by r_j
  AxisRotation<S> rotation_;
  Mat3<S> R_;
  std::array<S, 6> c_ = {S(0), S(0), S(0), S(0), S(0), S(0)};
};

}  // namespace anholon
