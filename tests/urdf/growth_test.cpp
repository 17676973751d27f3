// SPDX-License-Identifier: GPL-2.0-or-later

// How programs grow with the length of a chain, in operations: those of a recursion with its links, a matrix
// with its entries. bench/scale_table prints the same for more lengths, with times.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "derive/tree_functions.hpp"
#include "describe/read_robot.hpp"
#include "urdf/chain.hpp"

namespace anholon::growth_test {
namespace {

/// Slope of log(operations) over log(links) from 10 to 80 links.
double exponent(const std::string& function) {
  const auto operations = [&](int links) {
    TreeRequest request;
    request.functions = {function};
    const auto derivation = derive_tree(read_robot_text(testing::chain(links), "chain.urdf"), request);
    const auto chosen = std::ranges::find_if(derivation->candidates, &CandidateReport::chosen);
    return static_cast<double>(chosen->operations);
  };
  return std::log(operations(80) / operations(10)) / std::log(8);
}

class Growth : public ::testing::TestWithParam<std::pair<const char*, double>> {};

TEST_P(Growth, IsThatOfTheOutput) {
  const auto& [function, bound] = GetParam();
  EXPECT_LE(exponent(function), bound);
}

// 1.2 for a number of outputs that grows with the links, 2.2 for one that grows with their square
INSTANTIATE_TEST_SUITE_P(All, Growth,
                         ::testing::Values(std::pair{"inverse_dynamics", 1.2}, std::pair{"bias_forces", 1.2},
                                           std::pair{"gravity_forces", 1.2},
                                           std::pair{"forward_kinematics", 1.2},
                                           std::pair{"forward_dynamics", 1.2},
                                           std::pair{"centroidal_momentum", 1.2},
                                           std::pair{"mass_matrix", 2.2}),
                         [](const auto& info) { return info.param.first; });

}  // namespace
}  // namespace anholon::growth_test
