// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Where (A, B_p) loses rank, the imposed motion has to be compatible: a combination u of rows that no passive
// velocity enters leaves u . B_a r_a_dot = 0. Otherwise no finite motion goes through. A motion that cannot
// go on is told from one that passes, and the diagnosis names the time, the configuration, the rows and the
// rank.

#include <Eigen/Core>
#include <optional>
#include <string>

#include "simulate/runner.hpp"

namespace anholon {

class RankMonitor {
 public:
  RankMonitor(const SceneProgram& program, Runner<double>& run) : program_(program), run_(run) {}

  /// Why no finite motion goes through the state in the buffers, or nothing where one does.
  /// @param share  singular values below this part of the largest count as zero
  std::optional<std::string> obstacle(double t, double share);

  /// Largest singular value of (A, B_p) by the smallest that belongs to its generic rank, at the state in the
  /// buffers; 1 without rows.
  double condition();

  /// At the end of a step: whether (A, B_p) lost rank since the last one, and the motion could not pass
  /// there. Needs impose() and set() at (t, g, y), and leaves the buffers so.
  template <class G, class Vector>
  std::optional<std::string> passed(double t, const G& g, const Vector& y) {
    const Eigen::MatrixXd now = leading_rows();
    std::optional<std::string> found;
    if (now.size() > 0 && before_.rows() == now.rows() && turned_over(now)) {
      // the rows turn over where they lose rank: bisection, g being that of the end of the step
      double low = t_before_, high = t;
      const Eigen::VectorXd y_before = y_before_;
      for (int i = 0; i < bisections; ++i) {
        const double middle = (low + high) / 2, part = (middle - t_before_) / (t - t_before_);
        run_.impose(middle);
        run_.set(g, Eigen::VectorXd(y_before + part * (y - y_before)));
        (turned_over(leading_rows()) ? high : low) = middle;
      }
      found = obstacle(high, crossed);
      run_.impose(t);
      run_.set(g, y);
      leading_rows();
    }
    before_ = now, t_before_ = t, y_before_ = y;
    return found;
  }

 private:
  static constexpr int bisections = 50;
  static constexpr double crossed = 1e-6;  // where bisection has come close

  /// (A, B_p) and B_a by the program's function, columns in the order of the reduced partition.
  void read_rows();
  /// Those rows of (A, B_p) that are independent at most configurations.
  Eigen::MatrixXd leading_rows();
  /// Against those of the step before.
  [[nodiscard]] bool turned_over(const Eigen::MatrixXd& now) const;

  const SceneProgram& program_;
  Runner<double>& run_;
  Eigen::MatrixXd A_, B_, before_;
  Eigen::VectorXd y_before_;
  double t_before_ = 0;
};

}  // namespace anholon
