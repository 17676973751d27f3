// SPDX-License-Identifier: GPL-2.0-or-later
//
// Once the workspace is made, neither a step nor a value of the imposed motion allocates: every road to the
// heap is counted, operator new and (Eigen's way) malloc.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <vector>

#include "anholon/integrate/cf4.hpp"
#include "anholon/integrate/cooper_verner.hpp"
#include "anholon/integrate/dop853.hpp"
#include "anholon/integrate/dopri.hpp"
#include "anholon/integrate/rosenbrock.hpp"
#include "anholon/motion.hpp"
#include "run/lie_samples.hpp"
#include "run/manufactured_motion.hpp"

namespace {
std::atomic<long> allocations{0};
}

// Sanitizers bring their own malloc; glibc lets us pass ours on.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#if defined(__has_feature)
#if !__has_feature(address_sanitizer) && !__has_feature(thread_sanitizer) && !__has_feature(memory_sanitizer)
#define ANHOLON_COUNTS_MALLOC
#endif
#else
#define ANHOLON_COUNTS_MALLOC
#endif
#endif

#ifdef ANHOLON_COUNTS_MALLOC
// NOLINTNEXTLINE(bugprone-reserved-identifier): the name that glibc gives it
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
#endif

// Not inlined: the compiler would take the inner malloc and free for a mismatch with new and delete.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace anholon::testing::allocation_test {
namespace {

using integrate::AdaptiveOptions;
using integrate::Cf4Stages;
using integrate::Dop853;
using integrate::DormandPrince;
using integrate::Rkmk4;
using integrate::Rkmk8;
using integrate::RosenbrockStages;
using integrate::State;

/// The manufactured motion allocates; this field does not.
struct QuietField {
  template <class G, class Tangent, class Vector>
  void operator()(typename G::Scalar t, const G& g, const Vector& y, Tangent& eta, Vector& y_dot) const {
    for (int i = 0; i < G::dim; ++i) eta[i] = std::sin(t * (i + 1)) + y[i % y.size()] + g.p()[0] / 9;
    for (Eigen::Index i = 0; i < y.size(); ++i) y_dot[i] = std::cos(t) - y[i] * y[(i + 1) % y.size()];
  }
};

TEST(Allocation, IsSeenByTheCounter) {
  const long before = allocations;
  { const std::vector<double> vector(100); }
  EXPECT_GT(allocations - before, 0);
#ifdef ANHOLON_COUNTS_MALLOC
  const long between = allocations;
  { const Eigen::VectorXd vector(100); }
  EXPECT_GT(allocations - between, 0);
#endif
}

template <class G>
class AllocationOn : public ::testing::Test {};
using Groups = ::testing::Types<lie::SE3<double>, lie::SE2<long double>, lie::Trivial<double>>;
TYPED_TEST_SUITE(AllocationOn, Groups);

TYPED_TEST(AllocationOn, NoneHappensInAnIntegration) {
  using Real = typename TypeParam::Scalar;
  using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
  const QuietField quiet;
  const auto field = [&](Real t, const TypeParam& g, const Vector& y, auto& eta, Vector& y_dot) {
    quiet(t, g, y, eta, y_dot);
  };
  Rkmk4<TypeParam> rkmk4(40);  // beyond any small-size shortcut
  Rkmk8<TypeParam> rkmk8(40);
  Cf4Stages<TypeParam> cf4(40);
  DormandPrince<TypeParam> dopri(40);
  Dop853<TypeParam> dop853(40);
  State<TypeParam> state{0, {}, Vector::Constant(40, Real(0.1L))};
  const std::vector<Real> times = {Real(1.2L), Real(1.3L), Real(1.31L), Real(2)},
                          later = {Real(2.1L), Real(3)};
  AdaptiveOptions<Real> options;
  options.rtol = options.atol = Real(1e-5L);
  int reported = 0;

  const long before = allocations;
  const auto fixed = integrate_fixed(rkmk4, field, state, Real(1), 50);
  const auto adaptive = integrate_adaptive_at(dopri, field, state, times, options,
                                              [&](Real, const TypeParam&, const Vector&) { ++reported; });
  const auto of_order_8 = integrate_adaptive_at(dop853, field, state, later, options,
                                                [&](Real, const TypeParam&, const Vector&) { ++reported; });
  const auto by_rkmk8 = integrate_fixed(rkmk8, field, state, Real(3.2L), 5);
  const auto by_cf4 = integrate_fixed(cf4, field, state, Real(3.4L), 10);
  const long counted = allocations - before;

  EXPECT_EQ(counted, 0);
  EXPECT_TRUE(fixed);
  EXPECT_TRUE(adaptive);
  EXPECT_TRUE(of_order_8);
  EXPECT_TRUE(by_rkmk8);
  EXPECT_TRUE(by_cf4);
  EXPECT_EQ(reported, 6);
}

/// The same with its Jacobian.
template <class G>
struct QuietStiffField : QuietField {
  using Real = typename G::Scalar;
  template <class Vector, class Matrix>
  void jacobian(Real t, const G& g, const Vector& y, Matrix& F, Vector& F_t) const {
    F.setZero();
    F_t.setZero();
    for (int i = 0; i < G::dim; ++i) {
      for (int j = 0; j < G::linear_dim; ++j) F(i, j) = g.R()(0, j) / 9;
      F(i, G::dim + i % y.size()) = 1;
      F_t[i] = Real(i + 1) * std::cos(t * (i + 1));
    }
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      F(G::dim + i, G::dim + i) -= y[(i + 1) % y.size()];
      F(G::dim + i, G::dim + (i + 1) % y.size()) -= y[i];
      F_t[G::dim + i] = -std::sin(t);
    }
  }
};

TYPED_TEST(AllocationOn, NoneHappensInAStiffIntegration) {
  using Real = typename TypeParam::Scalar;
  for (const Eigen::Index size : {1, 7, 40}) {  // 40: beyond the block size of the factorisation
    using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
    RosenbrockStages<TypeParam> stages(size);
    State<TypeParam> state{0, {}, Vector::Constant(size, Real(0.1L))};
    AdaptiveOptions<Real> options;
    options.rtol = options.atol = Real(1e-4L);
    Vector y(size);
    const long before = allocations;
    const auto outcome = integrate_adaptive(stages, QuietStiffField<TypeParam>{}, state, Real(1), options,
                                            [&](const auto& step) {
                                              TypeParam g;
                                              step.evaluate((step.t_begin() + step.t_end()) / 2, g, y);
                                            });
    EXPECT_EQ(allocations - before, 0) << size;
    EXPECT_TRUE(outcome);
    EXPECT_LT(outcome.accepted_steps, 100);  // a wrong Jacobian would cost many
  }
}

TEST(Allocation, NoneHappensInTheImposedMotion) {
  const TabulatedMotion<double> motion({0, 1, 2, 3}, Eigen::MatrixXd::Random(4, 3));
  Eigen::VectorXd r(3), r_dot(3);
  double array[3];  // generated code takes arrays
  const long before = allocations;
  for (double t = -1; t < 4; t += 0.1) motion.evaluate(t, r, r_dot, Eigen::Map<Eigen::VectorXd>(array, 3));
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace anholon::testing::allocation_test
