// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/contact_forces.hpp"

#include <algorithm>
#include <cmath>

#include "reduce/decompositions.hpp"

namespace anholon {
namespace {

constexpr double zero_share = 1e-10;  // relative: between rounding and the shares of real contacts

/// Minimises |c + C s| over what earlier aims have left open, one aim after the other.
class Priorities {
 public:
  explicit Priorities(Eigen::Index size)
      : s_(Eigen::VectorXd::Zero(size)), open_(Eigen::MatrixXd::Identity(size, size)) {}

  void minimise(const Eigen::MatrixXd& C, const Eigen::VectorXd& c) {
    if (open_.cols() == 0 || C.rows() == 0) return;
    const Eigen::MatrixXd seen = C * open_;
    const SingularValues svd = singular_values(seen);
    // relative to the whole aim: what is left of it may be rounding
    const double zero = zero_share * std::max(C.norm(), 1e-300);
    Eigen::Index rank = 0;
    while (rank < svd.sigma.size() && svd.sigma(rank) > zero) ++rank;
    const Eigen::VectorXd aim = -(c + C * s_);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(open_.cols());
    for (Eigen::Index i = 0; i < rank; ++i)
      z += svd.V.col(i) * ((seen * svd.V.col(i)).dot(aim) / (svd.sigma(i) * svd.sigma(i)));
    s_ += open_ * z;
    open_ = Eigen::MatrixXd(open_ * svd.V.rightCols(open_.cols() - rank));
  }
  [[nodiscard]] const Eigen::VectorXd& solution() const { return s_; }

 private:
  Eigen::VectorXd s_;
  Eigen::MatrixXd open_;  // orthonormal directions that no aim has decided
};

Eigen::MatrixXd stacked(const std::vector<Eigen::MatrixXd>& blocks, Eigen::Index columns) {
  Eigen::Index rows = 0;
  for (const Eigen::MatrixXd& b : blocks) rows += b.rows();
  Eigen::MatrixXd all(rows, columns);
  rows = 0;
  for (const Eigen::MatrixXd& b : blocks) all.middleRows(rows, b.rows()) = b, rows += b.rows();
  return all;
}

}  // namespace

SharingRule least_norm_sharing() {
  return [](const SharingProblem& problem) -> Eigen::VectorXd {
    return Eigen::VectorXd::Zero(problem.N.cols());
  };
}

SharingRule equal_friction_sharing() {
  return [](const SharingProblem& problem) -> Eigen::VectorXd {
    constexpr double least_share = 1e-3;  // of the largest load: a contact that hardly presses carries little
    const Eigen::Index rows = problem.lambda.size();
    Priorities s(problem.N.cols());
    std::vector<Eigen::MatrixXd> loads;
    for (const ContactMap& contact : problem.contacts) loads.push_back(contact.normal);
    const Eigen::MatrixXd all_loads = stacked(loads, rows);
    s.minimise(all_loads * problem.N, all_loads * problem.lambda);

    const Eigen::VectorXd so_far = problem.lambda + problem.N * s.solution();
    double largest = 0;
    for (const ContactMap& contact : problem.contacts) {
      if (contact.normal.size() > 0) largest = std::max(largest, (contact.normal * so_far)(0));
    }
    std::vector<Eigen::MatrixXd> tangential;
    for (const ContactMap& contact : problem.contacts) {
      if (contact.normal.size() == 0 || contact.friction == 0 || largest == 0) continue;
      const double load = std::max((contact.normal * so_far)(0), least_share * largest);
      tangential.emplace_back(contact.tangential / std::sqrt(contact.friction * load));
    }
    const Eigen::MatrixXd all_tangential = stacked(tangential, rows);
    s.minimise(all_tangential * problem.N, all_tangential * problem.lambda);
    s.minimise(problem.N, problem.lambda);
    return s.solution();
  };
}

SharingRule sharing_rule(LoadSharing sharing) {
  return sharing == LoadSharing::least_norm ? least_norm_sharing() : equal_friction_sharing();
}

}  // namespace anholon
