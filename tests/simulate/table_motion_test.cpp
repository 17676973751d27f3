// SPDX-License-Identifier: GPL-2.0-or-later
// Imposed motion from a table: what its ends mean, and tables that do not have such ends.

#include "simulate/table_motion.hpp"

#include "simulate/columns.hpp"
#include "simulate/written_scene.hpp"

namespace anholon::table_motion_test {
namespace {

using testing::column_index;
using testing::test_folder;
using testing::written_scene;

const std::string carriage =
    testing::two_bodies.substr(0, testing::two_bodies.find("[[constraint]]"));  // without the latch

/// The second mass moves by a table.
Scene scene_of(const std::string& table, const std::string& ends, const std::string& times) {
  std::ofstream(test_folder() / "table.csv") << table;
  return written_scene(carriage, "duration = 3\ndrive = { r1 = \"motion\" }\noutput_times = " + times +
                                     "\nmotion = { table = \"table.csv\", ends = \"" + ends + "\" }\n");
}

constexpr double rounding = 1e-14;  // some ten operations on numbers of order one

TEST(TableMotion, OfClampedEndsRestsThereAndPassesThroughItsKnots) {
  const SimulationResult result =
      simulate_scene(scene_of("t,r1\n0,0.1\n1,0.7\n3,-0.2\n", "clamped", "[0, 1, 3]"));
  ASSERT_TRUE(result.finished) << result.status;
  ASSERT_EQ(result.rows.size(), 3U);
  const std::size_t r = column_index(result, "r1"), rate = column_index(result, "dot(r1)");
  const double knots[] = {0.1, 0.7, -0.2};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(result.rows[i][r], knots[i], rounding) << i;
  EXPECT_NEAR(result.rows[0][rate], 0, rounding);
  EXPECT_GT(std::abs(result.rows[1][rate]), 0.1);  // it passes
  EXPECT_NEAR(result.rows[2][rate], 0, rounding);
}

// From rest to rest through no other knot: r = h (3 s^2 - 2 s^3), s = t/T.
TEST(TableMotion, OfTwoClampedRowsIsTheCubicFromRestToRest) {
  const SimulationResult result = simulate_scene(scene_of("t,r1\n0,0\n3,2\n", "clamped", "[0.75, 1.5, 3]"));
  ASSERT_TRUE(result.finished) << result.status;
  ASSERT_GE(result.rows.size(), 3U);
  const std::size_t t = column_index(result, "t"), r = column_index(result, "r1"),
                    rate = column_index(result, "dot(r1)");
  for (const std::vector<double>& row : result.rows) {
    const double s = row[t] / 3;
    EXPECT_NEAR(row[r], 2 * (3 * s * s - 2 * s * s * s), rounding) << row[t];
    EXPECT_NEAR(row[rate], 2 * 6 * (s - s * s) / 3, rounding) << row[t];
  }
}

TEST(TableMotion, PeriodicOneThatDoesNotCloseIsRefusedWithItsFile) {
  try {
    scene_of("t,r1\n0,0\n1,0.3\n2,0.2\n3,0.1\n", "periodic", "[3]");
    FAIL() << "the table was accepted";
  } catch (const ModelError& error) {
    EXPECT_EQ(error.what(), (test_folder() / "table.csv").string() +
                                ":1:1: error: the table is periodic, but 'r1' begins with 0 and ends with "
                                "0.1; repeat the first row at the end of the period, or take other ends");
  }
}

// Written with the sine of double, which is 2.4e-16 at 2 pi: far more than a rounding of long double.
TEST(TableMotion, PeriodicOneThatClosesToRoundingClosesInLongDouble) {
  const Scene scene = scene_of("t,r1\n0,0\n1,1\n2,1.2246467991473532e-16\n3,-1\n4,-2.4492935982947064e-16\n",
                               "periodic", "[3]");
  const SceneProgram program = make_program(scene);
  TableMotion<long double> motion(scene, program);
  Buffers<long double> b;
  for (auto* v : {&b.r_m, &b.r_m_dot, &b.r_m_ddot}) v->resize(1);
  motion(4.0L, b);
  EXPECT_EQ(b.r_m[0], 0);
  // second derivatives at the knots are 0, -3, 0, 3; the table's roundings are 1e-16
  EXPECT_NEAR(static_cast<double>(b.r_m_dot[0]), 1.5, 1e-15);
}

}  // namespace
}  // namespace anholon::table_motion_test
