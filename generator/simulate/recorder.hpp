// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What is seen of a motion: rows of a trajectory at the wanted times, and the monitors at every step.

#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <vector>

#include "anholon/monitors.hpp"
#include "simulate/contact_forces.hpp"
#include "simulate/monitors.hpp"
#include "simulate/rank_monitor.hpp"
#include "simulate/runner.hpp"
#include "simulate/simulation.hpp"

namespace anholon {

class Recorder {
 public:
  /// Names the columns of `result`, to which rows are added.
  /// @param energy  of the whole motion, which may have other parts before this one
  Recorder(const SceneProgram& program, Runner<double>& run, EnergyMonitor& energy,
           const SharingRule& sharing, SimulationResult& result, const RowObserver& observer = {});
  Recorder(const Recorder&) = delete;  // columns point into it
  Recorder& operator=(const Recorder&) = delete;
  ~Recorder() = default;

  /// Monitors alone. @param y  (r_p, r_d, nu, work, dissipated)
  /// @param position_residual  of the conditions on the position [m or 1]
  template <class G, class Vector>
  void watch(double t, const G& g, const Vector& y, double position_residual) {
    look(t, g, y, position_residual);
    forget_sharing();
  }

  /// Monitors, and a row.
  template <class G, class Vector>
  void record(double t, const G& g, const Vector& y, double position_residual) {
    look(t, g, y, position_residual);
    add_row();
    forget_sharing();
  }

 private:
  template <class G, class Vector>
  void look(double t, const G& g, const Vector& y, double position_residual) {
    position_residual_ = position_residual;
    result_.position_residual = std::max(result_.position_residual, position_residual);
    run_.impose(t);
    run_.set(g, y);
    result_.departure = std::max(result_.departure, run_.departure());
    if (result_.violation.empty()) result_.violation = rank_.passed(t, g, y).value_or("");
    work_ = y(y.size() - 2), dissipated_ = y(y.size() - 1);
    result_.orthonormality = std::max(result_.orthonormality, orthonormality_defect(Eigen::Matrix3d(g.R())));
    observe();
  }
  void observe();
  void add_row();
  void name_contacts();
  void share_loads();
  void forget_sharing();  // the field goes on with lambda_stat = 0
  void observe_contacts(double t);

  const SceneProgram& program_;
  Runner<double>& run_;
  SimulationResult& result_;
  RowObserver observer_;
  std::vector<const double*> sources_;  // of the columns
  EnergyMonitor& energy_;
  CompatibilityMonitor compatibility_;
  RankMonitor rank_;
  const SharingRule& sharing_;
  SharingProblem problem_;
  struct ContactValues {
    double normal = 0, longitudinal = 0, lateral = 0, tangential = 0, utilisation = 0, flag = 0;
  };
  std::vector<ContactValues> contact_values_;
  double potential_ = 0, work_ = 0, dissipated_ = 0, defect_ = 0, residual_ = 0, position_residual_ = 0;
};

}  // namespace anholon
