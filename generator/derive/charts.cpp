// SPDX-License-Identifier: GPL-2.0-or-later
#include "derive/charts.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "anholon/charts.hpp"
#include "reduce/atlas.hpp"
#include "reduce/decompositions.hpp"

namespace anholon {
namespace {

constexpr double found = 1e-8;      // of the median: a descent that gets here would get to zero
constexpr double kept_rank = 1e-3;  // of the median: below, (A, B_p) itself is close to losing rank
constexpr int most_bases = 5;       // single bases that are tried
constexpr int most_rounds = 4;      // of making an atlas and looking for what it does not serve
constexpr double served = 0.05;     // of the median: quality of the best chart, everywhere
constexpr std::size_t most_charts = 16;

void append(Tape& tape, std::vector<NodeId>& nodes, const Matrix<Expr>& m) {
  for (const Expr& e : m.entries()) nodes.push_back(e.id(tape));
}

Eigen::MatrixXd matrix(const std::vector<double>& values, std::size_t at, int rows, int cols) {
  Eigen::MatrixXd m(rows, cols);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) m(i, j) = values[at + static_cast<std::size_t>(i * cols + j)];
  }
  return m;
}

class AtlasChooser {
 public:
  AtlasChooser(Tape& tape, const ProgramSymbols& symbols, const AtlasRequest& request)
      : tape_(tape), symbols_(symbols), request_(request) {
    for (const SampleState& s : request.samples) states_.push_back(rounded_configuration(s.state));
  }

  KernelAtlas run() {
    KernelAtlas atlas;
    for (int basis = 0; basis < most_bases; ++basis) {
      atlas.charts.clear();
      atlas.charts.push_back(std::make_unique<KinematicReduction>(
          tape_, request_.rows, *request_.ranks, request_.inverse, request_.preferred_free,
          request_.passive_names, symbols_.sampler(states_)));
      const Kernel& kernel = atlas.charts.front()->kernel();
      if (!may_be_singular(kernel)) return atlas;
      if (!search_) start_search();
      if (search_->is_constant()) return atlas;
      const auto singular = search_->lowest(basis_quality(kernel), found);
      if (!singular) return atlas;
      if (!atlas.first_basis_singular_at) atlas.first_basis_singular_at = search_->text_of(*singular);
      states_.push_back(*singular);
    }
    KernelAtlas made = make_charts(atlas.charts.front()->static_by_projection());
    if (made.charts.empty()) return atlas;  // `check` finds where the basis is singular
    made.first_basis_singular_at = atlas.first_basis_singular_at;
    return made;
  }

 private:
  /// A basis that divides by numbers alone needs no search, and one that the description asks for stays.
  [[nodiscard]] bool may_be_singular(const Kernel& kernel) const {
    const bool asked_for =
        !request_.preferred_free.empty() && std::ranges::all_of(request_.preferred_free, [&](int velocity) {
          return std::ranges::find(kernel.free, velocity) != kernel.free.end();
        });
    return kernel.H.cols() > 0 && request_.rows.A.rows() > 0 && !kernel.divides_by_constants && !asked_for;
  }

  void start_search() {
    const auto at = rows_at();
    search_.emplace(*request_.model, at);
    std::vector<double> qualities;
    for (const State<double>& s : search_->states()) qualities.push_back(independence(at(s)));
    typical_independence_ = ConfigurationSearch::median(qualities);
  }

  [[nodiscard]] ConfigurationSearch::Values rows_at() const {
    std::vector<NodeId> nodes;
    append(tape_, nodes, request_.rows.A);
    return symbols_.evaluator(nodes);
  }
  [[nodiscard]] Eigen::MatrixXd rows_of(const std::vector<double>& values) const {
    return matrix(values, 0, request_.rows.A.rows(), request_.rows.A.cols());
  }
  /// Smallest singular value of (A, B_p) that belongs to its rank, of the largest.
  [[nodiscard]] double independence(const std::vector<double>& values) const {
    const Eigen::MatrixXd A = rows_of(values);
    if (!A.allFinite()) return 0;
    const int rank = request_.ranks->m_locked;
    if (rank == 0) return 1;
    const Eigen::VectorXd sigma = singular_values(A).sigma;
    return sigma(rank - 1) / sigma(0);
  }
  [[nodiscard]] bool keeps_rank(const std::vector<double>& values) const {
    return independence(values) > kept_rank * typical_independence_;
  }

  /// 1 where H and J are of ordinary size and the columns of H independent; 0 where they are singular while
  /// the rows are not.
  [[nodiscard]] ConfigurationSearch::Quality basis_quality(const Kernel& kernel) const {
    std::vector<NodeId> nodes;
    append(tape_, nodes, request_.rows.A), append(tape_, nodes, kernel.H), append(tape_, nodes, kernel.J);
    const auto at = symbols_.evaluator(nodes);
    const std::size_t h_at = request_.rows.A.entries().size(), j_at = h_at + kernel.H.entries().size();
    const auto H_of = [h_at, rows = kernel.H.rows(), cols = kernel.H.cols()](const auto& values) {
      return matrix(values, h_at, rows, cols);
    };
    const auto J_of = [j_at](const auto& values) {
      double largest = 0;
      for (std::size_t i = j_at; i < values.size(); ++i) {
        const double x = std::abs(values[i]);
        if (x > largest || std::isnan(x)) largest = x;  // keeps not-a-number
      }
      return largest;
    };
    std::vector<double> columns, entries;
    for (const State<double>& s : search_->states()) {
      const std::vector<double> values = at(s);
      const Eigen::MatrixXd H = H_of(values);
      for (Eigen::Index c = 0; c < H.cols(); ++c) columns.push_back(H.col(c).norm());
      entries.push_back(J_of(values));
    }
    const double column = ConfigurationSearch::median(columns), entry = ConfigurationSearch::median(entries);
    return [=, this](const State<double>& s) {
      const std::vector<double> values = at(s);
      Eigen::MatrixXd H = H_of(values);
      const double J = J_of(values);
      double quality = 1;
      if (!H.allFinite() || !std::isfinite(J)) quality = 0;
      if (J > 0) quality = std::min(quality, entry / J);
      for (Eigen::Index c = 0; c < H.cols() && quality > 0; ++c) {
        const double size = H.col(c).norm();
        quality = std::min({quality, size / column, column / size});
        H.col(c) /= size;
      }
      if (quality > 0 && H.cols() > 1) {
        const Eigen::VectorXd sigma = singular_values(H).sigma;
        quality = std::min(quality, sigma(sigma.size() - 1) / sigma(0));
      }
      return quality < 1 && !keeps_rank(values) ? 1.0 : quality;
    };
  }

  KernelAtlas make_charts(bool static_by_projection) {
    KernelAtlas atlas;
    const auto rows = rows_at();
    for (const State<double>& s : search_->states()) states_.push_back(s);
    std::erase_if(states_, [&](const State<double>& s) { return !keeps_rank(rows(s)); });
    for (int round = 0; round < most_rounds; ++round) {
      std::vector<Eigen::MatrixXd> A;
      for (const State<double>& s : states_) A.push_back(rows_of(rows(s)));
      const std::vector<double> sizes = velocity_sizes(A);
      const ChartChoice choice(A, request_.ranks->m_locked, sizes);
      std::vector<std::vector<int>> free_sets = choice.free_sets();
      if (free_sets.size() > most_charts) free_sets.resize(most_charts);
      atlas = {};
      for (const std::vector<int>& free : free_sets) {
        std::vector<State<double>> domain;
        for (const std::size_t i : choice.domain(free)) domain.push_back(states_[i]);
        atlas.charts.push_back(std::make_unique<KinematicReduction>(
            tape_, request_.rows, *request_.ranks, request_.inverse,
            ChartRequest{free, symbols_.sampler(domain), static_by_projection}, request_.passive_names));
        atlas.quality.push_back(atlas.charts.back()->quality(sizes));
      }
      const auto unserved = search_->lowest(atlas_quality(atlas), served);
      if (!unserved) return atlas;
      atlas.singular_at = search_->text_of(*unserved);
      states_.push_back(*unserved);
    }
    return atlas;
  }

  /// That of the best chart, by its median.
  [[nodiscard]] ConfigurationSearch::Quality atlas_quality(const KernelAtlas& atlas) const {
    std::vector<NodeId> nodes;
    append(tape_, nodes, request_.rows.A);
    const std::size_t first = nodes.size();
    for (const Expr& e : atlas.quality) nodes.push_back(e.id(tape_));
    const auto best = [first](const std::vector<double>& values) {
      const std::span<const double> qualities(values.begin() + static_cast<std::ptrdiff_t>(first),
                                              values.end());
      const double largest = qualities[best_chart(qualities)];
      return largest > 0 ? largest : 0.0;  // also where it is not a number
    };
    const auto at = symbols_.evaluator(nodes);
    std::vector<double> ordinary;
    for (const State<double>& s : search_->states()) ordinary.push_back(best(at(s)));
    const double typical = ConfigurationSearch::median(ordinary);
    return [this, best, at, typical](const State<double>& s) {
      const std::vector<double> values = at(s);
      const double quality = best(values) / typical;
      return quality < served && !keeps_rank(values) ? 1.0 : quality;
    };
  }

  Tape& tape_;
  const ProgramSymbols& symbols_;
  const AtlasRequest& request_;
  std::optional<ConfigurationSearch> search_;  // where one is needed
  std::vector<State<double>> states_;          // samples, and what the searches found
  double typical_independence_ = 1;
};

}  // namespace

KernelAtlas choose_atlas(Tape& tape, const ProgramSymbols& symbols, const AtlasRequest& request) {
  return AtlasChooser(tape, symbols, request).run();
}

}  // namespace anholon
