// SPDX-License-Identifier: MIT
//
// Imposed motion r_a(t) from a table: the cubic spline through its rows, twice continuously differentiable,
// so that r_a, r_a_dot and r_a_ddot may all enter the dynamics. Second derivatives at the knots are the
// unknowns: de Boor 2001, "A Practical Guide to Splines", chapter IV; Press et al. 2007, "Numerical Recipes",
// section 3.3, and 2.7 for the cyclic system.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace anholon {

/// What closes the spline at its two ends, and how it goes on beyond them.
enum class SplineEnds {
  natural,   ///< second derivative 0; beyond: straight on, so still C2
  clamped,   ///< given slopes; beyond: straight on at these slopes, where the second derivative drops to 0
  periodic,  ///< last row = first row, two derivatives included; beyond: again and again
};

/// s coordinates as functions of time, through a table of n rows. Constant once made; evaluation allocates
/// nothing.
template <class Real>
class TabulatedMotion {
 public:
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  using Output = Eigen::Ref<Vector>;

  /// @param times    (n) strictly increasing [s]; n >= 2, or 4 for a periodic spline
  /// @param values   (n x s) row i: r_a at times[i]
  /// @param ends     closure; periodic asks for equal first and last rows
  /// @param slopes   (2 x s) r_a_dot at the first and the last time; read for clamped ends only
  /// @throws std::invalid_argument  on a table that is none of the above, naming the row
  TabulatedMotion(std::vector<Real> times, Matrix values, SplineEnds ends = SplineEnds::natural,
                  const Matrix& slopes = Matrix())
      : times_(std::move(times)), values_(std::move(values)), ends_(ends) {
    check(slopes);
    if (ends_ == SplineEnds::periodic) {
      values_.row(rows() - 1) = values_.row(0);  // equal to rounding: make it exact
      solve_periodic();
    } else {
      solve_open(slopes);
    }
  }

  Eigen::Index size() const { return values_.cols(); }  ///< s
  Real t_begin() const { return times_.front(); }
  Real t_end() const { return times_.back(); }

  /// r_a and its two derivatives at t. On an interval of length h, with a = (t_1 - t)/h, b = (t - t_0)/h:
  ///
  ///   r      = a r_0 + b r_1 + h^2/6 ((a^3 - a) m_0 + (b^3 - b) m_1)
  ///   r_dot  = (r_1 - r_0)/h + h/6 ((1 - 3 a^2) m_0 + (3 b^2 - 1) m_1)
  ///   r_ddot = a m_0 + b m_1
  ///
  /// with m the second derivatives at the knots.
  ///
  /// @param[in]   t  any time [s]
  /// @param[out]  r, r_dot, r_ddot  (s) each, every entry written; vectors or Eigen::Map of arrays
  void evaluate(Real t, Output r, Output r_dot, Output r_ddot) const {
    if (ends_ == SplineEnds::periodic) {
      const Real period = t_end() - t_begin();
      t -= period * std::floor((t - t_begin()) / period);
      t = std::clamp(t, t_begin(), t_end());  // rounding of the line above
    }
    const Real inside = std::clamp(t, t_begin(), t_end());
    const auto above = std::upper_bound(times_.begin() + 1, times_.end() - 1, inside);
    const Eigen::Index i = above - times_.begin() - 1;
    const Real h = times_[i + 1] - times_[i];
    const Real a = (times_[i + 1] - inside) / h, b = (inside - times_[i]) / h;
    const Real value_0 = h * h / 6 * (a * a * a - a), value_1 = h * h / 6 * (b * b * b - b);
    const Real slope_0 = h / 6 * (1 - 3 * a * a), slope_1 = h / 6 * (3 * b * b - 1);
    for (Eigen::Index j = 0; j < size(); ++j) {
      const Real r_0 = values_(i, j), r_1 = values_(i + 1, j);
      const Real m_0 = second_(i, j), m_1 = second_(i + 1, j);
      r[j] = a * r_0 + b * r_1 + value_0 * m_0 + value_1 * m_1;
      r_dot[j] = (r_1 - r_0) / h + slope_0 * m_0 + slope_1 * m_1;
      r_ddot[j] = a * m_0 + b * m_1;
    }
    if (inside != t) {  // before the first or after the last knot
      r += (t - inside) * r_dot;
      r_ddot.setZero();
    }
  }

 private:
  Eigen::Index rows() const { return values_.rows(); }
  Real interval(Eigen::Index i) const { return times_[i + 1] - times_[i]; }
  auto slope(Eigen::Index i) const { return (values_.row(i + 1) - values_.row(i)) / interval(i); }

  void check(const Matrix& slopes) const {
    const auto fail = [](const std::string& text) { throw std::invalid_argument("motion table: " + text); };
    const Eigen::Index least = ends_ == SplineEnds::periodic ? 4 : 2;
    if (rows() < least) {
      fail("expected at least " + std::to_string(least) + " rows, found " + std::to_string(rows()));
    }
    if (static_cast<Eigen::Index>(times_.size()) != rows()) {
      fail("expected as many times as rows, found " + std::to_string(times_.size()) + " times and " +
           std::to_string(rows()) + " rows");
    }
    for (Eigen::Index i = 0; i < rows(); ++i) {
      if (!std::isfinite(times_[i]) || !values_.row(i).allFinite()) {
        fail("row " + std::to_string(i) + " has a value that is not finite");
      }
      if (i > 0 && !(times_[i - 1] < times_[i])) {
        fail("times must increase, but that of row " + std::to_string(i) + " does not exceed the one before");
      }
    }
    if (ends_ == SplineEnds::clamped &&
        (slopes.rows() != 2 || slopes.cols() != size() || !slopes.allFinite())) {
      fail("clamped ends need 2 x " + std::to_string(size()) + " finite slopes, found " +
           std::to_string(slopes.rows()) + " x " + std::to_string(slopes.cols()));
    }
    if (ends_ == SplineEnds::periodic) {
      // A table made with sin(2 pi k/n) closes to a few roundings of its largest entry, not exactly.
      const Real tolerance =
          16 * std::numeric_limits<Real>::epsilon() * values_.cwiseAbs().sum() / Real(rows());
      for (Eigen::Index j = 0; j < size(); ++j) {
        if (!(std::abs(values_(rows() - 1, j) - values_(0, j)) <= tolerance)) {
          fail("periodic ends need the last row equal to the first, but column " + std::to_string(j) +
               " differs");
        }
      }
    }
  }

  /// h_{i-1} m_{i-1} + 2 (h_{i-1} + h_i) m_i + h_i m_{i+1} = 6 (slope_i - slope_{i-1}), and one row at each
  /// end.
  void solve_open(const Matrix& slopes) {
    const Eigen::Index n = rows();
    const bool clamped = ends_ == SplineEnds::clamped;
    Vector lower = Vector::Zero(n), diagonal = Vector::Ones(n), upper = Vector::Zero(n);
    second_ = Matrix::Zero(n, size());
    for (Eigen::Index i = 1; i + 1 < n; ++i) {
      lower[i] = interval(i - 1);
      diagonal[i] = 2 * (interval(i - 1) + interval(i));
      upper[i] = interval(i);
      second_.row(i) = 6 * (slope(i) - slope(i - 1));
    }
    if (clamped) {
      diagonal[0] = 2 * interval(0);
      upper[0] = interval(0);
      second_.row(0) = 6 * (slope(0) - slopes.row(0));
      lower[n - 1] = interval(n - 2);
      diagonal[n - 1] = 2 * interval(n - 2);
      second_.row(n - 1) = 6 * (slopes.row(1) - slope(n - 2));
    }
    solve_tridiagonal(lower, diagonal, upper, second_);
  }

  /// The same rows with indices modulo n - 1. The two corner entries h are taken out as a matrix of rank one,
  /// h u u^T with u = e_first + e_last, which leaves a diagonally dominant system (Sherman & Morrison).
  void solve_periodic() {
    const Eigen::Index n = rows() - 1;
    Vector lower(n), diagonal(n), upper(n);
    Matrix right(n, size() + 1);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index before = (i + n - 1) % n;
      lower[i] = interval(before);
      diagonal[i] = 2 * (interval(before) + interval(i));
      upper[i] = interval(i);
      right.row(i).head(size()) = 6 * (slope(i) - slope(before));
    }
    const Real corner = interval(n - 1);
    diagonal[0] -= corner;
    diagonal[n - 1] -= corner;
    right.col(size()).setZero();
    right(0, size()) = right(n - 1, size()) = Real(1);  // u
    solve_tridiagonal(lower, diagonal, upper, right);
    const Vector z = right.col(size());
    const Real denominator = 1 + corner * (z[0] + z[n - 1]);
    second_.resize(n + 1, size());
    for (Eigen::Index j = 0; j < size(); ++j) {
      const Real factor = corner * (right(0, j) + right(n - 1, j)) / denominator;
      second_.col(j).head(n) = right.col(j) - factor * z;
    }
    second_.row(n) = second_.row(0);
  }

  /// Thomas' elimination; the matrices above are diagonally dominant, so no pivots are needed.
  static void solve_tridiagonal(const Vector& lower, Vector diagonal, const Vector& upper, Matrix& right) {
    const Eigen::Index n = diagonal.size();
    for (Eigen::Index i = 1; i < n; ++i) {
      const Real factor = lower[i] / diagonal[i - 1];
      diagonal[i] -= factor * upper[i - 1];
      right.row(i) -= factor * right.row(i - 1);
    }
    right.row(n - 1) /= diagonal[n - 1];
    for (Eigen::Index i = n - 1; i-- > 0;) {
      right.row(i) = (right.row(i) - upper[i] * right.row(i + 1)) / diagonal[i];
    }
  }

  std::vector<Real> times_;
  Matrix values_;  ///< (n x s)
  Matrix second_;  ///< (n x s) second derivatives at the knots
  SplineEnds ends_;
};

}  // namespace anholon
