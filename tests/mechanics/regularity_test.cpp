// SPDX-License-Identifier: GPL-2.0-or-later
//
// A basis that is singular somewhere in the working range is found, and told from constraints that lose rank.
#include "check/regularity.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "describe/read_model.hpp"

namespace anholon::regularity_test {
namespace {

Regularity searched(const Model& model) {
  DeriveRequest request;
  request.functions = {"kinematics", "constraints"};
  request.closed_forms = false;
  return search_singularities(model, *derive(model, request));
}

Model shipped(const std::string& name) {
  return read_model(std::string(ANHOLON_SOURCE_DIR) + "/models/" + name + "/" + name + ".toml");
}

/// A body that turns about a point, but not about the vertical of the world.
Model without_spin() {
  return read_model_text(R"toml(
anholon = 1
name = "without_spin"
group = "SO3"
[[body]]
name = "ball"
inertia = { about_com = { xx = 1, yy = 2, zz = 2.5 } }
[[constraint]]
name = "no_spin"
row = "R_ZX*Omega_X + R_ZY*Omega_Y + R_ZZ*Omega_Z"
)toml",
                         "without_spin.toml");
}

// The directions across the vertical have no basis that is regular for every attitude (there is no field of
// directions on the sphere): whichever was chosen, an entry of the vertical that it divides by passes zero.
// Several charts serve them all.
TEST(Regularity, FindsThatNoBasisServesEveryAttitude) {
  const Model model = without_spin();
  DeriveRequest request;
  request.functions = {"kinematics", "constraints"};
  request.closed_forms = false;
  const auto derivation = derive(model, request);
  ASSERT_TRUE(derivation->reduction.why_charts);
  const std::string& where = *derivation->reduction.why_charts;
  const std::string last_row = where.substr(where.rfind('['));
  EXPECT_TRUE(last_row.find("[0, ") == 0 || last_row.find(", 0, ") != std::string::npos ||
              last_row.find(", 0]") != std::string::npos)
      << where;
  EXPECT_GT(derivation->reduction.charts.size(), 1U);
  EXPECT_FALSE(derivation->reduction.unserved);
  const Regularity found = search_singularities(model, *derivation);
  EXPECT_FALSE(found.singular_basis);
  EXPECT_FALSE(found.rank_drop);
}

// A trailer on its hitch: (Omega_Z, r1_dot) cannot be free when it stands straight, where V_X moves with both
// at rest.
TEST(Regularity, FindsAnUnluckyChoiceOfFreeVelocities) {
  Model model = shipped("trailer");
  EXPECT_FALSE(searched(model).singular_basis);
  model.free_velocities = {"Omega_Z", "r1"};
  const Regularity found = searched(model);
  ASSERT_TRUE(found.singular_basis);
  EXPECT_TRUE(*found.singular_basis == "r1 = 0" || found.singular_basis->starts_with("r1 = 3.14") ||
              found.singular_basis->starts_with("r1 = -3.14"))
      << *found.singular_basis;
  EXPECT_FALSE(found.rank_drop);
}

// The snake loses rank where its three axles meet in a point; that is no fault of the basis.
TEST(Regularity, TellsRankDropsFromSingularBases) {
  const Regularity found = searched(shipped("wheeled_snake3"));
  EXPECT_FALSE(found.singular_basis);
  ASSERT_TRUE(found.rank_drop);
  double r1 = 0, r2 = 1;
  char name[3];
  std::istringstream text(*found.rank_drop);  // "r1 = 0.8, r2 = 0.8"
  text >> name[0] >> name[1] >> name[2] >> r1 >> name[0] >> name[1] >> name[2] >> name[0] >> r2;
  EXPECT_NEAR(r1, r2, 0.011) << *found.rank_drop;  // printed with three digits
}

TEST(Regularity, IsGrantedToTheOtherModels) {
  for (const char* name :
       {"mobile_pendulum", "mobile_pendulum_one_wheel", "bicycle", "rigid_snakeboard", "soft_snakeboard"})
    EXPECT_EQ(searched(shipped(name)).singular_basis, std::nullopt) << name;
}

}  // namespace
}  // namespace anholon::regularity_test
