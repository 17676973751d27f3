// SPDX-License-Identifier: GPL-2.0-or-later
// Accelerations next to configurations where the velocities that a description names are almost dependent.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "check/error_measure.hpp"
#include "check/evaluate_program.hpp"
#include "describe/read_model.hpp"
#include "reduce/elimination.hpp"
#include "reduce/samples.hpp"
#include "singular/exact_inputs.hpp"

namespace anholon::orthogonal_basis_test {
namespace {

TEST(OrthogonalBasis, TimesItsTriangleIsTheBasis) {
  Tape tape;
  Matrix<Expr> H(4, 3);
  int next = 0;
  for (const int x : {3, 1, -4, 1, 5, 9, -2, 6, 5, 3, 5, 8}) H(next / 3, next % 3) = Expr(x), ++next;
  const OrthogonalBasis basis = orthogonal_basis(H);
  const auto value = [](const Expr& e) { return e.constant_value().value(); };
  const Matrix<Expr> product = basis.Q * basis.R, gram = basis.Q.transposed() * basis.Q;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(value(basis.R(i, i)), Exact(1));
    for (int j = 0; j < 3; ++j) {
      if (j < i) {
        EXPECT_EQ(value(basis.R(i, j)), Exact(0));
      }
      if (j != i) {
        EXPECT_EQ(value(gram(i, j)), Exact(0));  // fractions: no rounding
      }
    }
    for (int row = 0; row < 4; ++row) EXPECT_EQ(value(product(row, i)), value(H(row, i)));
  }
  const std::vector<Expr> x = basis.solve({Expr(2), Expr(-1), Expr(7)});
  const std::vector<Expr> b = basis.R * x;
  EXPECT_EQ(value(b[0]), Exact(2));
  EXPECT_EQ(value(b[1]), Exact(-1));
  EXPECT_EQ(value(b[2]), Exact(7));
}

/// Worst error of nu_dot of the Whipple bicycle, relative to its largest entry times the size of the basis,
/// at those of many states where the basis is largest.
double worst_error(OptimiseFor aim) {
  const Model model =
      read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/whipple_bicycle/whipple_bicycle.toml");
  DeriveRequest request;
  request.functions = {"kinematics", "forward_dynamics"};
  request.closed_forms = false;
  request.optimise = aim;
  const auto derivation = derive(model, request);
  const std::vector<Exact> parameters = test::rounded_parameters(model);
  const auto exact = interpreting_caller<Exact>(derivation->program, parameters);
  std::vector<double> rounded;
  for (const Exact& x : parameters) rounded.push_back(x.to_double());
  const auto in_double = interpreting_caller<double>(derivation->program, rounded);

  struct Try {
    double size_of_basis;
    test::BothInputs in;
  };
  std::vector<Try> tries;
  SampleSource source(11);
  const Partition partition = partition_of(model);
  for (int s = 0; s < 2500; ++s) {
    Try t;
    NamedValues<Exact> in = position_inputs(model, partition, random_state(model, source));
    for (int i = 0; i < 3; ++i) in["nu"].push_back(source.uniform(Exact(-1), Exact(1)));
    for (const auto& [name, values] : in) {
      std::vector<double> x;
      for (const Exact& value : values) x.push_back(value.to_double());
      t.in.set(name, x);
    }
    t.size_of_basis = size_of(in_double("kinematics", t.in.rounded).at("H"));
    tries.push_back(std::move(t));
  }
  std::ranges::sort(tries, std::greater<>(), &Try::size_of_basis);
  double worst = 0;
  for (int i = 0; i < 20; ++i) {
    const auto& [size, in] = tries[static_cast<std::size_t>(i)];
    const double error = test::distance(in_double("forward_dynamics", in.rounded).at("nu_dot"),
                                        exact("forward_dynamics", in.exact).at("nu_dot"));
    worst = std::max(worst, error / size);
  }
  return worst;
}

TEST(OrthogonalBasis, OfTheWhippleBicycleLosesDigitsWithTheConditionNotItsSquare) {
  const double balanced = worst_error(OptimiseFor::balanced), first = worst_error(OptimiseFor::nothing);
  EXPECT_LT(balanced, 50 * eps);  // a few operations each; 12 at the worst of these states
  EXPECT_GT(first, 1000 * eps);   // else the route is not needed
}

}  // namespace
}  // namespace anholon::orthogonal_basis_test
