// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// The integrators of the runtime for fields and observers known at run time, instantiated once:
// integrators.cpp.

#include <Eigen/Core>
#include <functional>

#include "anholon/integrate/result.hpp"
#include "anholon/integrate/step_control.hpp"
#include "describe/scene.hpp"
#include "simulate/groups.hpp"

namespace anholon {

/// (t, g, y) -> (eta, y_dot), and what is done to the state at the end of a step.
template <class G>
struct Field {
  std::function<void(double t, const G& g, const Eigen::VectorXd& y, typename G::Tangent& eta,
                     Eigen::VectorXd& y_dot)>
      rates;
  std::function<bool(double t, G& g, Eigen::VectorXd& y)> correction;  // whether it moved; may be empty
  std::function<void(double t, const G& g, const Eigen::VectorXd& y, Eigen::MatrixXd& F,
                     Eigen::VectorXd& F_t)>
      derivative = {};  // as jacobian() in rosenbrock.hpp; may be empty

  void operator()(double t, const G& g, const Eigen::VectorXd& y, typename G::Tangent& eta,
                  Eigen::VectorXd& y_dot) const {
    rates(t, g, y, eta, y_dot);
  }
  bool correct(double t, G& g, Eigen::VectorXd& y) const { return correction && correction(t, g, y); }
  void jacobian(double t, const G& g, const Eigen::VectorXd& y, Eigen::MatrixXd& F,
                Eigen::VectorXd& F_t) const {
    derivative(t, g, y, F, F_t);
  }
};
/// Of anything that an integrator of the runtime takes as a field with corrections.
template <class G, class From>
Field<G> field_with_corrections(const From& from) {
  return {from, [from](double t, G& g, Eigen::VectorXd& y) { return from.correct(t, g, y); },
          [from](double t, const G& g, const Eigen::VectorXd& y, Eigen::MatrixXd& F, Eigen::VectorXd& F_t) {
            from.jacobian(t, g, y, F, F_t);
          }};
}

/// A step just accepted, of any method; the solution inside it, anholon/integrate/dense.hpp.
template <class G>
class AnyStep {
 public:
  virtual ~AnyStep() = default;
  [[nodiscard]] virtual double t_begin() const = 0;
  [[nodiscard]] virtual double t_end() const = 0;
  [[nodiscard]] virtual const G& g_end() const = 0;
  [[nodiscard]] virtual const Eigen::VectorXd& y_end() const = 0;
  virtual void evaluate(double t, G& g, Eigen::VectorXd& y) const = 0;
  /// The Jacobian at the beginning of the step; of the stiff method only.
  [[nodiscard]] virtual const Eigen::MatrixXd* jacobian() const { return nullptr; }
};
template <class G>
using DenseObserver = std::function<void(const AnyStep<G>&)>;
template <class G>
using StepObserver = std::function<void(double t, const G& g, const Eigen::VectorXd& y)>;

/// With step control.
/// @param method  dopri5, dopri8 or rodas5p, which needs the derivative of the field
template <class G>
integrate::Result<double> integrate_adaptive(const Field<G>& field, integrate::State<G>& state, double t_end,
                                             const integrate::AdaptiveOptions<double>& options,
                                             const DenseObserver<G>& observer,
                                             Integrator::Method method = Integrator::Method::dopri5);

/// With equal steps.
/// @param method  rkmk4, rkmk8 or cf4
template <class G>
integrate::Result<double> integrate_fixed(const Field<G>& field, integrate::State<G>& state, double t_end,
                                          long steps, const StepObserver<G>& observer,
                                          Integrator::Method method = Integrator::Method::rkmk4);

}  // namespace anholon
