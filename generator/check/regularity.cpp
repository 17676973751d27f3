// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/regularity.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "anholon/charts.hpp"
#include "check/evaluate_program.hpp"
#include "reduce/configuration_search.hpp"
#include "reduce/decompositions.hpp"

namespace anholon {
namespace {

constexpr double found = 1e-8;      // of the median: a descent that gets here would get to zero
constexpr double kept_rank = 1e-3;  // of the median: below, (A, B_p) itself is close to losing rank

class Search {
 public:
  Search(const Model& model, const Derivation& derivation)
      : model_(model),
        partition_(derivation.reduction.partition),
        positions_(partition_of(model)),
        k_(derivation.reduction.kernel.H.cols()),
        rank_(derivation.reduction.ranks.m_locked),
        rows_(derivation.reduction.ranks.rows),
        leading_rows_(derivation.reduction.ranks.leading_rows),
        charts_(derivation.reduction.charts.size()),
        call_(interpreting_caller<double>(derivation.program, defaults(model))),
        search_(model, [this](const State<double>& s) { return at(s).entries(); }) {
    std::vector<double> columns, entries, independence;
    for (const State<double>& s : search_.states()) {
      const Matrices m = at(s);
      for (Eigen::Index c = 0; c < m.H.cols(); ++c) columns.push_back(m.H.col(c).norm());
      if (m.J.size() > 0) entries.push_back(m.J.cwiseAbs().maxCoeff());
      independence.push_back(rank_quality(m));
    }
    column_size_ = ConfigurationSearch::median(columns), J_size_ = ConfigurationSearch::median(entries),
    independence_ = ConfigurationSearch::median(independence);
  }

  Regularity run() {
    Regularity result;
    if (search_.is_constant()) return result;
    const auto dropped =
        search_.lowest([this](const State<double>& s) { return rank_quality(at(s)) / independence_; }, found);
    if (dropped) {
      result.rank_drop = search_.text_of(*dropped);
      const Eigen::MatrixXd A = at(*dropped).A;
      std::vector<std::vector<double>> rows;
      for (Eigen::Index i = 0; i < A.rows(); ++i) rows.emplace_back(A.row(i).begin(), A.row(i).end());
      result.dropped_rows = dependent_rows(rows, leading_rows_);
    }
    result.singular_basis = text_of_lowest([this](const State<double>& s) {
      const Matrices m = at(s);
      return rank_quality(m) > kept_rank * independence_ ? basis_quality(m) : 1.0;
    });
    return result;
  }

 private:
  struct Matrices {
    Eigen::MatrixXd A, H, J;  // (A, B_p): rows x passive; passive x k; passive x active
    [[nodiscard]] std::vector<double> entries() const {
      std::vector<double> all;
      for (const auto* m : {&A, &H, &J}) all.insert(all.end(), m->data(), m->data() + m->size());
      return all;
    }
  };

  static std::vector<double> defaults(const Model& model) {
    std::vector<double> values;
    for (const Parameter& p : model.parameters) values.push_back(p.value.to_double());
    return values;
  }

  std::optional<std::string> text_of_lowest(const ConfigurationSearch::Quality& quality) {
    const auto lowest = search_.lowest(quality, found);
    return lowest ? std::optional(search_.text_of(*lowest)) : std::nullopt;
  }

  [[nodiscard]] Matrices at(const State<double>& s) const {
    const NamedValues<double> in = position_inputs(model_, positions_, s);
    const auto read = [](const NamedValues<double>& out, const std::string& name, int rows, int cols) {
      Eigen::MatrixXd m = Eigen::MatrixXd::Zero(rows, cols);
      const auto values = out.find(name);
      if (values == out.end()) return m;
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < cols; ++j) m(i, j) = values->second[static_cast<std::size_t>(i * cols + j)];
      }
      return m;
    };
    const int passive = static_cast<int>(partition_.passive.size());
    std::string chart;
    if (charts_ > 1) {
      const std::vector<double> quality = call_("chart_quality", in).at("quality");
      chart = chart_prefix(best_chart(std::span<const double>(quality)));
    }
    const NamedValues<double> kinematics = call_(chart + "kinematics", in), rows = call_("constraints", in);
    Matrices m{Eigen::MatrixXd::Zero(rows_, passive), read(kinematics, "H", passive, k_),
               read(kinematics, "J", passive, partition_.s_a())};
    const Eigen::MatrixXd A = read(rows, "A", rows_, positions_.n),
                          B_p = read(rows, "B_p", rows_, positions_.s_p()),
                          B_a = read(rows, "B_a", rows_, positions_.s_a());
    for (int j = 0; j < passive; ++j) {  // torque-driven coordinates are columns of B_a
      const int velocity = partition_.passive[static_cast<std::size_t>(j)];
      const auto active = std::ranges::find(positions_.active, velocity);
      m.A.col(j) = j < positions_.n                    ? A.col(j)
                   : active != positions_.active.end() ? B_a.col(active - positions_.active.begin())
                                                       : B_p.col(j - positions_.n);
    }
    return m;
  }

  /// Smallest singular value of (A, B_p) that belongs to its rank, of the largest.
  [[nodiscard]] double rank_quality(const Matrices& m) const {
    if (rank_ == 0) return 1;
    const Eigen::VectorXd sigma = singular_values(m.A).sigma;
    return sigma(rank_ - 1) / sigma(0);
  }
  /// 1 where H and J are of ordinary size and the columns of H independent; 0 where they are singular.
  [[nodiscard]] double basis_quality(const Matrices& m) const {
    if (!m.H.allFinite() || !m.J.allFinite()) return 0;
    double quality = 1;
    if (m.J.size() > 0) quality = std::min(quality, J_size_ / std::max(m.J.cwiseAbs().maxCoeff(), 1e-300));
    if (m.H.cols() == 0) return quality;
    Eigen::MatrixXd h = m.H;
    for (Eigen::Index c = 0; c < h.cols(); ++c) {
      const double size = h.col(c).norm();
      if (size == 0) return 0;
      quality = std::min({quality, size / column_size_, column_size_ / size});
      h.col(c) /= size;
    }
    const Eigen::VectorXd sigma = singular_values(h).sigma;
    return std::min(quality, sigma(sigma.size() - 1) / sigma(0));
  }

  const Model& model_;
  const Partition& partition_;
  Partition positions_;  // of the program's position inputs
  int k_, rank_, rows_;
  std::vector<int> leading_rows_;
  std::size_t charts_;
  ProgramCaller<double> call_;
  ConfigurationSearch search_;
  double column_size_ = 1, J_size_ = 1, independence_ = 1;
};

}  // namespace

Regularity search_singularities(const Model& model, const Derivation& derivation) {
  if (derivation.reduction.ranks.rows == 0 || derivation.reduction.partition.passive.empty()) return {};
  return Search(model, derivation).run();
}

}  // namespace anholon
