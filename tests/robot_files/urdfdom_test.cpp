// SPDX-License-Identifier: GPL-2.0-or-later

// URDF files as urdfdom reads them, the reader of ROS: places, axes, inertias, ranges, couplings.

#ifdef ANHOLON_HAVE_URDFDOM

#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <filesystem>

#include "describe/read_bytes.hpp"
#include "describe/read_robot.hpp"
#include "robot_files/zero_pose.hpp"

namespace anholon::urdfdom_test {
namespace {

namespace fs = std::filesystem;

Vec3<double> vector(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }
Mat3<double> matrix(const urdf::Rotation& q) {
  Mat3<double> R;
  for (int i = 0; i < 3; ++i) {
    const urdf::Vector3 column = q * urdf::Vector3(i == 0, i == 1, i == 2);
    R(0, i) = column.x, R(1, i) = column.y, R(2, i) = column.z;
  }
  return R;
}

/// A pose of urdfdom's in the root link.
struct Placed {
  Mat3<double> R = Mat3<double>::identity();
  Vec3<double> p;
};

void compare(const fs::path& file) {
  RobotOptions options;
  options.as_written = true;  // urdfdom does not snap
  const Model model = read_robot(file, options);
  const auto seen = testing::seen_links(model);
  const urdf::ModelInterfaceSharedPtr theirs = urdf::parseURDF(read_bytes(file));
  ASSERT_NE(theirs, nullptr);
  EXPECT_EQ(theirs->links_.size(), model.bodies.size());
  const auto place = [&](const urdf::Link* link) {
    Placed at;
    for (; link->parent_joint != nullptr; link = link->getParent().get()) {
      const urdf::Pose& pose = link->parent_joint->parent_to_joint_origin_transform;
      at.p = vector(pose.position) + matrix(pose.rotation) * at.p;
      at.R = matrix(pose.rotation) * at.R;
    }
    return at;
  };
  constexpr double rounding = 1e-14;  // of a chain of at most ten quaternions, in metres
  for (const auto& [name, link] : theirs->links_) {
    ASSERT_TRUE(seen.contains(name)) << name;
    const testing::SeenLink& ours = seen.at(name);
    const Placed at = place(link.get());
    EXPECT_LT(testing::distance(ours.p, at.p), rounding) << name;
    EXPECT_LT(testing::distance(ours.R, at.R), rounding) << name;
    if (link->inertial != nullptr) {
      const urdf::Inertial& i = *link->inertial;
      const Vec3<double> c = vector(i.origin.position);
      const Mat3<double> R = matrix(i.origin.rotation);
      const Mat3<double> I = {i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz};
      EXPECT_EQ(ours.mass, i.mass) << name;
      EXPECT_LT(testing::distance(ours.first_moment, i.mass * c), rounding * (1 + i.mass)) << name;
      EXPECT_LT(testing::distance(ours.inertia, testing::about_origin(R * I * R.transposed(), i.mass, c)),
                rounding * (1 + i.mass))
          << name;
    } else {
      EXPECT_EQ(ours.mass, 0) << name;
    }
    const auto joint = link->parent_joint;
    if (joint == nullptr || joint->type == urdf::Joint::FIXED) continue;
    EXPECT_LT(testing::distance(ours.axis, at.R * vector(joint->axis)), rounding) << name;
    const auto c = std::ranges::find(model.coordinates, joint->name, &Coordinate::name);
    if (joint->mimic != nullptr) {
      EXPECT_EQ(c, model.coordinates.end()) << joint->name;
      continue;
    }
    ASSERT_NE(c, model.coordinates.end()) << joint->name;
    if (joint->type == urdf::Joint::CONTINUOUS || joint->limits == nullptr) continue;
    EXPECT_EQ(c->lower.to_double(), joint->limits->lower);
    EXPECT_EQ(c->upper.to_double(), joint->limits->upper);
  }
}

TEST(Urdfdom, RobotsOfThisProject) {
  const fs::path root(ANHOLON_SOURCE_DIR);
  for (const char* name : {"arm7", "quadruped", "humanoid"})
    compare(root / "models" / name / (std::string(name) + ".urdf"));
  for (const char* name : {"arm.urdf", "walker.urdf"}) compare(root / "tests" / "robot_files" / name);
}

TEST(Urdfdom, RobotsThatAreGiven) {
  if (std::string(ANHOLON_ROBOTS).empty()) GTEST_SKIP() << "ANHOLON_ROBOTS is not set";
  for (const auto& entry : fs::directory_iterator(ANHOLON_ROBOTS)) {
    SCOPED_TRACE(entry.path().filename());
    if (entry.path().extension() == ".urdf") compare(entry.path());
  }
}

}  // namespace
}  // namespace anholon::urdfdom_test

#endif
