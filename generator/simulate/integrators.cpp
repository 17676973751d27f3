// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/integrators.hpp"

#include "anholon/integrate/cf4.hpp"
#include "anholon/integrate/cooper_verner.hpp"
#include "anholon/integrate/dop853.hpp"
#include "anholon/integrate/dopri.hpp"
#include "anholon/integrate/rkmk.hpp"
#include "anholon/integrate/rosenbrock.hpp"

namespace anholon {
namespace {

template <class G, class Step>
class StepOf final : public AnyStep<G> {
 public:
  explicit StepOf(const Step& step) : step_(step) {}
  [[nodiscard]] double t_begin() const override { return step_.t_begin(); }
  [[nodiscard]] double t_end() const override { return step_.t_end(); }
  [[nodiscard]] const G& g_end() const override { return step_.g_end(); }
  [[nodiscard]] const Eigen::VectorXd& y_end() const override { return step_.y_end(); }
  void evaluate(double t, G& g, Eigen::VectorXd& y) const override { step_.evaluate(t, g, y); }
  [[nodiscard]] const Eigen::MatrixXd* jacobian() const override {
    if constexpr (requires { step_.stages().jacobian(); }) {
      return &step_.stages().jacobian();
    } else {
      return nullptr;
    }
  }

 private:
  const Step& step_;
};

template <class Stages, class G>
integrate::Result<double> adaptive(const Field<G>& field, integrate::State<G>& state, double t_end,
                                   const integrate::AdaptiveOptions<double>& options,
                                   const DenseObserver<G>& observer) {
  Stages stages(state.y.size());
  return integrate::integrate_adaptive(
      stages, field, state, t_end, options,
      [&]<class Step>(const Step& step) { observer(StepOf<G, Step>(step)); });
}

template <class Stages, class G>
integrate::Result<double> fixed(const Field<G>& field, integrate::State<G>& state, double t_end, long steps,
                                const StepObserver<G>& observer) {
  Stages stages(state.y.size());
  return integrate::integrate_fixed(stages, field, state, t_end, steps, observer);
}

}  // namespace

template <class G>
integrate::Result<double> integrate_adaptive(const Field<G>& field, integrate::State<G>& state, double t_end,
                                             const integrate::AdaptiveOptions<double>& options,
                                             const DenseObserver<G>& observer, Integrator::Method method) {
  if (method == Integrator::Method::dopri8)
    return adaptive<integrate::Dop853<G>>(field, state, t_end, options, observer);
  if (method == Integrator::Method::rodas5p)
    return adaptive<integrate::RosenbrockStages<G>>(field, state, t_end, options, observer);
  return adaptive<integrate::DormandPrince<G>>(field, state, t_end, options, observer);
}

template <class G>
integrate::Result<double> integrate_fixed(const Field<G>& field, integrate::State<G>& state, double t_end,
                                          long steps, const StepObserver<G>& observer,
                                          Integrator::Method method) {
  if (method == Integrator::Method::rkmk8)
    return fixed<integrate::Rkmk8<G>>(field, state, t_end, steps, observer);
  if (method == Integrator::Method::cf4)
    return fixed<integrate::Cf4Stages<G>>(field, state, t_end, steps, observer);
  return fixed<integrate::Rkmk4<G>>(field, state, t_end, steps, observer);
}

#define ANHOLON_INSTANTIATE(G)                                                                            \
  template integrate::Result<double> integrate_adaptive(const Field<G>&, integrate::State<G>&, double,    \
                                                        const integrate::AdaptiveOptions<double>&,        \
                                                        const DenseObserver<G>&, Integrator::Method);     \
  template integrate::Result<double> integrate_fixed(const Field<G>&, integrate::State<G>&, double, long, \
                                                     const StepObserver<G>&, Integrator::Method)
ANHOLON_INSTANTIATE(lie::SE3<double>);
ANHOLON_INSTANTIATE(lie::SE2<double>);
ANHOLON_INSTANTIATE(lie::SO3<double>);
using Translation3 = lie::Translation<double, 3>;
ANHOLON_INSTANTIATE(Translation3);
ANHOLON_INSTANTIATE(lie::Trivial<double>);
#undef ANHOLON_INSTANTIATE

}  // namespace anholon
