// SPDX-License-Identifier: GPL-2.0-or-later
#include "simulate/reference_solution.hpp"

#include <algorithm>
#include <cmath>

#include "simulate/final_state.hpp"
#include "simulate/gauss_collocation.hpp"
#include "simulate/groups.hpp"
#include "simulate/initial_state.hpp"
#include "simulate/radau_collocation.hpp"
#include "simulate/runner.hpp"

namespace anholon {

template <class S>
double state_error(const std::vector<S>& state, const std::vector<long double>& reference,
                   const MotionSizes& sizes) {
  std::vector<double> scale(9, 1);
  scale.insert(scale.end(), 3, sizes.length);
  scale.insert(scale.end(), sizes.shape.begin(), sizes.shape.end());
  scale.insert(scale.end(), sizes.nu.begin(), sizes.nu.end());
  double worst = reference.empty() ? INFINITY : 0;  // nothing is near what is not known
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double error =
        static_cast<double>(std::abs(static_cast<long double>(state[i]) - reference[i])) / scale[i];
    worst = std::isfinite(error) ? std::max(worst, error) : INFINITY;
  }
  return worst;
}

template double state_error(const std::vector<double>&, const std::vector<long double>&, const MotionSizes&);
template double state_error(const std::vector<long double>&, const std::vector<long double>&,
                            const MotionSizes&);

ReferenceSolution reference_solution(const Scene& scene, const SceneProgram& program,
                                     const MotionSizes& sizes, double enough) {
  constexpr int gauss_stages = 6, radau_stages = 5;
  constexpr long first_steps = 32, most_steps = 1L << 17;
  constexpr double settled =
      1e-17;  // a twentieth of double's last place; long double keeps this over 1e5 steps
  ReferenceSolution best;
  best.own_error = INFINITY;
  const bool by_newton = program.jacobian_operations > 0;
  best.method = by_newton ? "Radau collocation of order 9" : "Gauss collocation of order 12";
  with_group<long double>(program.model.group, [&]<class G>(std::type_identity<G>) {
    Runner<long double> run(scene, program, &program.derivation->program);
    const integrate::State<G> initial = initial_state<G>(scene, program, run, 0);
    const auto field = run.template charted_field<G>();
    const std::size_t chart = run.chart();
    std::vector<long double> coarser;
    for (long steps = first_steps; steps <= most_steps; steps *= 2) {
      integrate::State<G> state = initial;
      run.use_chart(chart);
      const auto t_end = static_cast<long double>(scene.duration);
      if (!(by_newton ? integrate_radau<radau_stages>(field, state, t_end, steps)
                      : integrate_gauss<gauss_stages>(field, state, t_end, steps))) {
        coarser.clear();
        continue;
      }
      run.express_in_best_chart(state);
      std::vector<long double> finer = final_values(state);
      if (!coarser.empty()) {
        const double difference = state_error(finer, coarser, sizes);
        const bool worse = difference >= best.own_error;  // rounding has taken over
        if (!worse) best = {finer, steps, difference, best.method};
        if (difference < std::max(settled, enough) || (worse && best.own_error < 1e-12)) return;
      }
      coarser = std::move(finer);
    }
  });
  return best;
}

}  // namespace anholon
