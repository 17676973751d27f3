// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/regularity.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>

#include "anholon/lie/so3.hpp"
#include "check/evaluate_program.hpp"
#include "reduce/decompositions.hpp"
#include "reduce/samples.hpp"

namespace anholon {
namespace {

constexpr int random_states = 200;
constexpr int descents = 8;         // from the worst of them
constexpr int steps_each = 250;     // for each coordinate that matters
constexpr double found = 1e-8;      // of the median: a descent that gets here would get to zero
constexpr double kept_rank = 1e-3;  // of the median: below, (A, B_p) itself is close to losing rank

using Quality = std::function<double(const State<double>&)>;

class Search {
 public:
  Search(const Model& model, const Derivation& derivation)
      : model_(model),
        partition_(derivation.reduction.partition),
        positions_(partition_of(model)),
        k_(derivation.reduction.kernel.H.cols()),
        rank_(derivation.reduction.ranks.m_locked),
        rows_(derivation.reduction.ranks.rows),
        call_(interpreting_caller<double>(derivation.program, defaults(model))) {
    for (int i = 0; i < random_states; ++i) states_.push_back(rounded(random_state(model, source_)));
    find_dependence();
    std::vector<Eigen::MatrixXd> H, J;
    std::vector<double> columns, entries, independence;
    for (const State<double>& s : states_) {
      const Matrices m = at(s);
      for (Eigen::Index c = 0; c < m.H.cols(); ++c) columns.push_back(m.H.col(c).norm());
      if (m.J.size() > 0) entries.push_back(m.J.cwiseAbs().maxCoeff());
      independence.push_back(rank_quality(m));
    }
    column_size_ = median(columns), J_size_ = median(entries), independence_ = median(independence);
  }

  Regularity run() {
    Regularity result;
    if (coordinates_.empty() && !orientation_) return result;  // the same everywhere
    result.rank_drop = lowest([this](const State<double>& s) { return rank_quality(at(s)) / independence_; });
    result.singular_basis = lowest([this](const State<double>& s) {
      const Matrices m = at(s);
      return rank_quality(m) > kept_rank * independence_ ? basis_quality(m) : 1.0;
    });
    return result;
  }

 private:
  struct Matrices {
    Eigen::MatrixXd A, H, J;  // (A, B_p): rows x passive; passive x k; passive x active
  };

  static std::vector<double> defaults(const Model& model) {
    std::vector<double> values;
    for (const Parameter& p : model.parameters) values.push_back(p.value.to_double());
    return values;
  }
  static State<double> rounded(const State<Exact>& from) {
    State<double> s;
    for (std::size_t i = 0; i < 9; ++i) s.R.m[i] = from.R.m[i].to_double();
    for (int i = 0; i < 3; ++i) s.p[i] = from.p[i].to_double();
    for (const Exact& x : from.r) s.r.push_back(x.to_double());
    s.r_dot.assign(s.r.size(), 0.0);
    return s;
  }
  static double median(std::vector<double> values) {
    std::erase_if(values, [](double x) { return !std::isfinite(x); });
    if (values.empty()) return 1;
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return std::max(values[values.size() / 2], 1e-300);
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
    const NamedValues<double> kinematics = call_("kinematics", in), rows = call_("constraints", in);
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

  /// Moves one coordinate, or the orientation, of one random state to those of another.
  void find_dependence() {
    const auto differs = [this, base = at(states_[0])](const State<double>& s) {
      const Matrices m = at(s);
      return m.A != base.A || m.H != base.H || m.J != base.J;
    };
    for (std::size_t i = 0; i < model_.coordinates.size(); ++i) {
      State<double> moved = states_[0];
      moved.r[i] = states_[1].r[i];
      if (differs(moved)) coordinates_.push_back(i);
    }
    State<double> turned = states_[0];
    turned.R = states_[1].R;
    orientation_ = differs(turned);
  }

  /// A random neighbour within the working range.
  State<double> neighbour(const State<double>& s, double step) {
    State<double> moved = s;
    const auto symmetric = [this] { return 2 * source_.uniform() - 1; };
    for (const std::size_t i : coordinates_) {
      const double lower = model_.coordinates[i].lower.to_double(),
                   upper = model_.coordinates[i].upper.to_double();
      moved.r[i] = std::clamp(s.r[i] + step * (upper - lower) * symmetric(), lower, upper);
    }
    if (orientation_) {
      Eigen::Vector3d turn(3 * step * symmetric(), 3 * step * symmetric(), 3 * step * symmetric());
      if (model_.group == GroupKind::SE2) turn.head<2>().setZero();
      const Eigen::Matrix3d R = lie::SO3<double>::exp(turn).R();
      Mat3<double> by;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) by(i, j) = R(i, j);
      }
      moved.R = s.R * by;
    }
    return moved;
  }

  /// The configuration where a quality of at most 1 falls to nothing, if a descent finds one.
  std::optional<std::string> lowest(const Quality& quality) {
    std::vector<std::pair<double, std::size_t>> ranked;
    for (std::size_t i = 0; i < states_.size(); ++i) ranked.emplace_back(quality(states_[i]), i);
    std::ranges::sort(ranked);
    const int dimensions = static_cast<int>(coordinates_.size()) + (orientation_ ? 3 : 0);
    for (int d = 0; d < descents; ++d) {
      State<double> best = states_[ranked[static_cast<std::size_t>(d)].second];
      double least = ranked[static_cast<std::size_t>(d)].first;
      double step = 0.1;  // of the range
      for (int i = 0; i < steps_each * dimensions && least > found && step > 1e-14; ++i) {
        const State<double> tried = neighbour(best, step);
        const double value = quality(tried);
        const bool better = value < least;
        if (better) best = tried, least = value;
        step *= better ? 1.7 : 0.87;  // keeps about one success in five
        step = std::min(step, 0.5);
      }
      if (least <= found) return text_of(best);
    }
    return std::nullopt;
  }

  [[nodiscard]] std::string text_of(const State<double>& s) const {
    std::string text;
    const auto rounded = [](double x) { return fmt::format("{:.3g}", std::abs(x) < 5e-4 ? 0.0 : x); };
    for (const std::size_t i : coordinates_)
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", model_.coordinates[i].name, rounded(s.r[i]));
    if (!orientation_) return text;
    text += text.empty() ? "R = [" : ", R = [";
    for (int i = 0; i < 3; ++i)
      text += fmt::format("{}[{}, {}, {}]", i == 0 ? "" : ", ", rounded(s.R(i, 0)), rounded(s.R(i, 1)),
                          rounded(s.R(i, 2)));
    return text + "]";
  }

  const Model& model_;
  const Partition& partition_;
  Partition positions_;  // of the program's position inputs
  int k_, rank_, rows_;
  ProgramCaller<double> call_;
  SampleSource source_{4};  // another seed than the derivation's
  std::vector<State<double>> states_;
  std::vector<std::size_t> coordinates_;  // on which the matrices depend
  bool orientation_ = false;
  double column_size_ = 1, J_size_ = 1, independence_ = 1;
};

}  // namespace

Regularity search_singularities(const Model& model, const Derivation& derivation) {
  if (derivation.reduction.ranks.rows == 0 || derivation.reduction.partition.passive.empty()) return {};
  return Search(model, derivation).run();
}

}  // namespace anholon
