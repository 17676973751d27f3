// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/integrators.hpp"

namespace anholon {

template <class G>
integrate::Result<double> integrate_adaptive(const Field<G>& field, integrate::State<G>& state, double t_end,
                                             const integrate::AdaptiveOptions<double>& options,
                                             const DenseObserver<G>& observer) {
  integrate::DormandPrince<G> stages(state.y.size());
  return integrate::integrate_adaptive(stages, field, state, t_end, options, observer);
}

template <class G>
integrate::Result<double> integrate_fixed(const Field<G>& field, integrate::State<G>& state, double t_end,
                                          long steps, const StepObserver<G>& observer) {
  integrate::Rkmk4<G> stages(state.y.size());
  return integrate::integrate_fixed(stages, field, state, t_end, steps, observer);
}

#define ANHOLON_INSTANTIATE(G)                                                                            \
  template integrate::Result<double> integrate_adaptive(const Field<G>&, integrate::State<G>&, double,    \
                                                        const integrate::AdaptiveOptions<double>&,        \
                                                        const DenseObserver<G>&);                         \
  template integrate::Result<double> integrate_fixed(const Field<G>&, integrate::State<G>&, double, long, \
                                                     const StepObserver<G>&)
ANHOLON_INSTANTIATE(lie::SE3<double>);
ANHOLON_INSTANTIATE(lie::SE2<double>);
ANHOLON_INSTANTIATE(lie::SO3<double>);
using Translation3 = lie::Translation<double, 3>;
ANHOLON_INSTANTIATE(Translation3);
ANHOLON_INSTANTIATE(lie::Trivial<double>);
#undef ANHOLON_INSTANTIATE

}  // namespace anholon
