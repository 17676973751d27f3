// SPDX-License-Identifier: GPL-2.0-or-later
// The Whipple bicycle steered past 80 degrees: its accelerations agree with exact arithmetic to the digits
// that the condition of the rows leaves.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "reduce/decompositions.hpp"
#include "singular/exact_inputs.hpp"
#include "singular/wheeled_snake.hpp"

namespace anholon::steered_test {
namespace {

TEST(SteeredBicycle, KeepsTheDigitsThatItsConditionLeaves) {
  Model model = test::shipped("whipple_bicycle");
  for (Coordinate& c : model.coordinates) {
    if (c.name == "steer") c.lower = Exact::ratio(-16, 10), c.upper = Exact::ratio(16, 10);
  }
  DeriveRequest request;
  request.functions = {"forward_dynamics", "constraints", "kinematics"};
  request.closed_forms = false;
  const auto derivation = derive(model, request);
  const auto generated = compiled_caller(derivation->program, test::rounded_parameters(model));
  const auto exact = interpreting_caller<Exact>(derivation->program, test::rounded_parameters(model));
  const WorkingDigits precision(50);
  const double degree = std::numbers::pi / 180;
  for (const double steer : {80.5, -82.0, 85.0, 88.0, -89.0}) {
    for (const double lean : {0.0, 0.2, -0.5}) {
      SCOPED_TRACE(::testing::Message() << steer << " degrees, lean " << lean);
      const Eigen::Matrix3d R = Eigen::AngleAxisd(lean, Eigen::Vector3d::UnitX()).toRotationMatrix();
      test::BothInputs in;
      std::vector<double> rotation;
      for (int i = 0; i < 9; ++i) rotation.push_back(R(i / 3, i % 3));
      in.set("R", rotation);
      in.set("p", {0, 0, 0});
      in.set("r_p", {0.3, steer * degree, -0.7});  // rear spin, steer, front spin
      in.set("nu", {0.4, -0.6, -8.0});
      in.set("eta", {0, 0, 0, 0, 0, 0}), in.set("r_p_dot", {0, 0, 0});
      const auto rows = generated("constraints", in.rounded);
      const Eigen::Index count = static_cast<Eigen::Index>(rows.at("A").size() / 6);
      Eigen::MatrixXd A(count, 9);
      for (Eigen::Index i = 0; i < count; ++i) {
        for (Eigen::Index j = 0; j < 6; ++j) A(i, j) = rows.at("A")[static_cast<std::size_t>(6 * i + j)];
        for (Eigen::Index j = 0; j < 3; ++j)
          A(i, 6 + j) = rows.at("B_p")[static_cast<std::size_t>(3 * i + j)];
      }
      const Eigen::VectorXd sigma = singular_values(A).sigma;
      double largest =
          1;  // of H: near 90 degrees the rear wheel, which the description names as free, is blocked
      const auto kinematics = generated("kinematics", in.rounded);
      for (const double h : kinematics.at("H")) largest = std::max(largest, std::abs(h));
      const double condition = largest * sigma(0) / sigma(count - 1);
      const auto got = generated("forward_dynamics", in.rounded);
      const auto want = exact("forward_dynamics", in.exact);
      // accelerations come from a system whose matrix has the square of the condition, errors of 1e-15 an
      // entry
      for (const auto& [name, values] : want)
        EXPECT_LT(test::distance(got.at(name), values), 1e-14 * std::max(10.0, condition * condition))
            << name;
    }
  }
}

}  // namespace
}  // namespace anholon::steered_test
