// SPDX-License-Identifier: GPL-2.0-or-later
// Over-constrained systems: a motion that the rows do not allow is refused with its time and row, or moved to
// the nearest that they allow. And what `check` knows of redundant rows and of ranks that change.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "check/regularity.hpp"
#include "derive/derive.hpp"
#include "simulate/columns.hpp"
#include "simulate/simulation.hpp"
#include "singular/wheeled_snake.hpp"

namespace anholon::compatibility_test {
namespace {

/// Five links: five axles on three velocities, so that two of the four joints are bound by the others.
SimulationResult snake(const std::string& lines) {
  const std::string folder = test::models_folder() + "wheeled_snake5/";
  return simulate_scene(
      read_scene_text("anholon = 1\nname = \"test\"\nmodel = \"wheeled_snake5.toml\"\nduration = 2\n"
                      "integrator = { method = \"dopri5\", tolerance = 1e-10 }\n" +
                          lines,
                      folder + "test.scene.toml"));
}

const std::string wave =
    "motion = { r1 = \"0.5 + 0.2*sin(2*t)\", r2 = \"-0.4 + 0.2*sin(2*t + 0.8)\", "
    "r3 = \"0.3 + 0.2*sin(2*t + 1.6)\", r4 = \"-0.5 + 0.2*sin(2*t + 2.4)\" }\n";

TEST(Compatibility, RefusesAMotionThatTheRowsDoNotAllow) {
  try {
    snake(wave);
    FAIL() << "no error";
  } catch (const ModelError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("the initial velocities violate constraint 'no_lateral_slip_link_"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("make the motion compatible at t = 0"), std::string::npos) << text;
  }
}

// At rest at the start, and on its way the first step shows what it wants.
TEST(Compatibility, StopsWhenTheMotionBecomesIncompatible) {
  const SimulationResult result = snake(
      "motion = { r1 = \"0.5 + 0.05*t^3\", r2 = \"-0.4 + 0.1*t^3\", r3 = \"0.3 + 0.15*t^3\", "
      "r4 = \"-0.5 + 0.2*t^3\" }\n");
  EXPECT_FALSE(result.finished);
  ASSERT_FALSE(result.rows.empty());
  EXPECT_LT(result.rows.back()[0], 1);  // it does stop
  EXPECT_TRUE(result.status.starts_with("the imposed rates violate row 'no_lateral_slip_link_"))
      << result.status;
  EXPECT_NE(result.status.find(" at t = "), std::string::npos) << result.status;
}

TEST(Compatibility, ProjectsTheMotionWhereTheSceneSaysSo) {
  const SimulationResult result = snake("incompatible_motion = \"project\"\n" + wave);
  ASSERT_TRUE(result.finished) << result.status;
  EXPECT_TRUE(result.projected);
  EXPECT_GT(result.departure, 1e-3);             // it had to give way
  EXPECT_LT(result.constraint_residual, 1e-13);  // all five rows; condition of the shapes about 25
  EXPECT_LT(result.energy_balance, 1e-8);        // accelerations are the derivatives of the rates
}

// A motion that is compatible stays what it is: the joints at rest while the snake coasts along its track is
// not possible for a bent snake with three independent rows, so the four joints rest and so does it.
TEST(Compatibility, LeavesACompatibleMotionAlone) {
  const std::string rest = "motion = { r1 = \"0.5\", r2 = \"-0.4\", r3 = \"0.3\", r4 = \"-0.5\" }\n";
  for (const std::string key : {"", "incompatible_motion = \"project\"\n"}) {
    const SimulationResult result = snake(key + rest);
    EXPECT_TRUE(result.finished) << result.status;
    EXPECT_EQ(result.departure, 0);
  }
}

RankAnalysis ranks_of(const Model& model) {
  DeriveRequest request;
  request.functions = {"kinematics", "constraints"};
  request.closed_forms = false;
  return derive(model, request)->reduction.ranks;
}

TEST(Ranks, TellRowsThatBindTheMotionFromRowsThatAreRedundantAltogether) {
  Model model = test::shipped("wheeled_snake5");
  const RankAnalysis five = ranks_of(model);
  EXPECT_EQ(five.rows, 5);
  EXPECT_EQ(five.m, 5);
  EXPECT_EQ(five.m_locked, 3);
  EXPECT_EQ(five.conditions, (std::vector<int>{3, 4}));
  EXPECT_TRUE(five.redundant.empty());

  model.rows.push_back(model.rows[1]);  // the second wheel of the same axle
  model.rows.back().name = "second_wheel";
  const RankAnalysis six = ranks_of(model);
  EXPECT_EQ(six.rows, 6);
  EXPECT_EQ(six.m, 5);
  EXPECT_EQ(six.m_locked, 3);
  EXPECT_EQ(six.conditions, (std::vector<int>{3, 4}));
  EXPECT_EQ(six.redundant, (std::vector<int>{5}));
  EXPECT_EQ(six.table_I_class(partition_of(model)), five.table_I_class(partition_of(model)));
}

/// Every class of Table I, with a row that is redundant altogether and without.
TEST(Ranks, ClassifyEveryCaseOfTableI) {
  struct Case {
    const char* model;
    const char* drive;
    std::string expected;
  };
  for (const Case& c : {Case{"wheeled_snake3", "active", "H empty, lambda_stat = 0 (kinematic)"},
                        Case{"wheeled_snake5", "active", "H empty, lambda_stat undetermined (kinematic)"},
                        Case{"wheeled_snake3", "passive", "H nonzero, lambda_stat = 0 (dynamic)"},
                        Case{"mobile_pendulum", "", "H nonzero, lambda_stat undetermined (dynamic)"}}) {
    Model model = test::shipped(c.model);
    for (Coordinate& coordinate : model.coordinates) {
      if (std::string(c.drive) == "passive") coordinate.drive = Drive::passive;
    }
    const RankAnalysis without = ranks_of(model);
    EXPECT_EQ(without.table_I_class(partition_of(model)), c.expected) << c.model;
    model.rows.push_back(model.rows[0]);
    const RankAnalysis with = ranks_of(model);
    EXPECT_EQ(with.table_I_class(partition_of(model)), c.expected) << c.model;
    EXPECT_EQ(with.m, without.m);
    EXPECT_EQ(with.m_locked, without.m_locked);
    EXPECT_EQ(with.redundant.size(), without.redundant.size() + 1);
  }
}

TEST(Ranks, SayWhereTheyDropAndWhichRowsDependThere) {
  const RankAnalysis snake = ranks_of(test::shipped("wheeled_snake3"));
  ASSERT_FALSE(snake.drops.empty());
  for (const RankAnalysis::Drop& drop : snake.drops) {
    EXPECT_EQ(drop.rank, 2);
    // three axles through one point; bent to right angles, those of the first and the last link are one line
    const bool right_angles = drop.where.ends_with("pi/2");
    EXPECT_EQ(drop.rows, right_angles ? (std::vector<int>{0, 2}) : (std::vector<int>{0, 1, 2})) << drop.where;
  }
  const RankAnalysis board = ranks_of(test::shipped("rigid_snakeboard"));
  ASSERT_EQ(board.drops.size(), 2U);
  EXPECT_EQ(board.drops[0].where, "r1 = pi/2");
  EXPECT_EQ(board.drops[0].rows, (std::vector<int>{0, 1}));
}

// A rank that changes on a surface which samples miss: the search names it, and the rows.
TEST(Ranks, AreSearchedBetweenTheSamples) {
  const Model model = read_model_text(R"toml(
anholon = 1
name = "slotted"
group = "SE2"
[[body]]
name = "plate"
inertia = { mass = 1, about_com = { zz = 0.1 } }
[[body]]
name = "arm"
parent = "plate"
joint = { kind = "revolute", axis = [0, 0, 1], coordinate = "r1", drive = "active" }
inertia = { mass = 0.1, about_com = { zz = 0.01 } }
[[constraint]]
name = "first"
row = "V_X"
[[constraint]]
name = "second"
row = "V_X + (sin(r1) - 0.3)*V_Y"
)toml",
                                      "slotted.toml");
  DeriveRequest request;
  request.functions = {"kinematics", "constraints"};
  request.closed_forms = false;
  const auto derivation = derive(model, request);
  EXPECT_TRUE(derivation->reduction.ranks.drops.empty());
  const Regularity found = search_singularities(model, *derivation);
  ASSERT_TRUE(found.rank_drop);
  EXPECT_TRUE(*found.rank_drop == "r1 = 0.305" || *found.rank_drop == "r1 = 2.84") << *found.rank_drop;
  EXPECT_EQ(found.dropped_rows, (std::vector<int>{0, 1}));
}

}  // namespace
}  // namespace anholon::compatibility_test
