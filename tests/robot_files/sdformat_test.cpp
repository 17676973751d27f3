// SPDX-License-Identifier: GPL-2.0-or-later

// SDFormat files as libsdformat reads them: places, axes and points on them, inertias, ranges, springs.

#ifdef ANHOLON_HAVE_SDFORMAT

#include <gtest/gtest.h>

#include <algorithm>
#include <sdf/Joint.hh>
#include <sdf/JointAxis.hh>
#include <sdf/Link.hh>
#include <sdf/Model.hh>
#include <sdf/Root.hh>

#include "describe/read_bytes.hpp"
#include "robot_files/same_robot.hpp"
#include "robot_files/zero_pose.hpp"

namespace anholon::sdformat_test {
namespace {

using ignition::math::Pose3d;

Vec3<double> vector(const ignition::math::Vector3d& v) { return {v.X(), v.Y(), v.Z()}; }
Mat3<double> matrix(const ignition::math::Matrix3d& m) {
  Mat3<double> R;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R(i, j) = m(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  }
  return R;
}

/// @param text  of the file that `model` was read from
void compare(const std::string& text, const Model& model) {
  sdf::Root root;
  const sdf::Errors errors = root.LoadSdfString(text);
  ASSERT_TRUE(errors.empty()) << errors.front().Message();
  const sdf::Model& theirs = *root.Model();
  const auto seen = testing::seen_links(model);
  // our reference body is the world, or the root link
  const sdf::Link* base = theirs.LinkByName(model.bodies[0].name);
  Pose3d base_pose;  // in the model
  if (base != nullptr) {
    ASSERT_TRUE(base->SemanticPose().Resolve(base_pose, "__model__").empty());
  } else {
    base_pose = theirs.RawPose().Inverse();
  }
  constexpr double rounding = 1e-14;  // of a chain of at most ten quaternions, in metres
  for (std::uint64_t i = 0; i < theirs.LinkCount(); ++i) {
    const sdf::Link& link = *theirs.LinkByIndex(i);
    ASSERT_TRUE(seen.contains(link.Name())) << link.Name();
    const testing::SeenLink& ours = seen.at(link.Name());
    Pose3d pose;
    ASSERT_TRUE(link.SemanticPose().Resolve(pose, "__model__").empty());
    pose = base_pose.Inverse() * pose;
    EXPECT_LT(testing::distance(ours.p, vector(pose.Pos())), rounding) << link.Name();
    EXPECT_LT(testing::distance(ours.R, matrix(ignition::math::Matrix3d(pose.Rot()))), rounding)
        << link.Name();
    const auto& inertial = link.Inertial();
    const double m = inertial.MassMatrix().Mass();
    const Vec3<double> c = vector(inertial.Pose().Pos());
    EXPECT_EQ(ours.mass, m) << link.Name();
    EXPECT_LT(testing::distance(ours.first_moment, m * c), rounding * (1 + m)) << link.Name();
    EXPECT_LT(testing::distance(ours.inertia, testing::about_origin(matrix(inertial.Moi()), m, c)),
              rounding * (1 + m))
        << link.Name();
  }
  for (std::uint64_t i = 0; i < theirs.JointCount(); ++i) {
    const sdf::Joint& joint = *theirs.JointByIndex(i);
    if (joint.Type() == sdf::JointType::FIXED) continue;
    const auto body = std::ranges::find_if(
        model.bodies, [&](const BodyDescription& b) { return b.joint.coordinate == joint.Name(); });
    ASSERT_NE(body, model.bodies.end()) << joint.Name();
    const testing::SeenLink& ours = seen.at(body->name);
    ignition::math::Vector3d axis;
    ASSERT_TRUE(joint.Axis()->ResolveXyz(axis, "__model__").empty());
    const Vec3<double> their_axis = vector(base_pose.Rot().Inverse() * axis);
    EXPECT_LT(testing::distance(ours.axis, their_axis), rounding) << joint.Name();
    Pose3d place;
    ASSERT_TRUE(joint.SemanticPose().Resolve(place, "__model__").empty());
    const Vec3<double> off = vector((base_pose.Inverse() * place).Pos()) - ours.p;
    const bool is_slide = joint.Type() == sdf::JointType::PRISMATIC;  // else our body's origin is on the axis
    EXPECT_LT(is_slide ? 0 : testing::distance(cross(their_axis, off), {}), rounding) << joint.Name();
    const auto c = std::ranges::find(model.coordinates, joint.Name(), &Coordinate::name);
    ASSERT_NE(c, model.coordinates.end()) << joint.Name();
    if (joint.Axis()->Lower() < -1e15) continue;
    EXPECT_EQ(c->lower.to_double(), joint.Axis()->Lower());
    EXPECT_EQ(c->upper.to_double(), joint.Axis()->Upper());
  }
}

TEST(Sdformat, RobotsOfThisFolder) {
  for (const char* name : {"arm.sdf", "walker.sdf"}) {
    SCOPED_TRACE(name);
    const auto path = std::filesystem::path(ANHOLON_SOURCE_DIR) / "tests" / "robot_files" / name;
    compare(read_bytes(path), testing::robot(name));
  }
}

/// Links posed at their centres, joints beside them, a chain of <frame>s, axes of other frames.
TEST(Sdformat, FramesEverywhere) {
  const std::string body =
      "<inertial><pose>0.01 0.02 0.03 0.1 0.2 0.3</pose><mass>2</mass><inertia><ixx>0.03</ixx><iyy>0.04</iyy>"
      "<izz>0.05</izz><ixy>0.001</ixy><ixz>-0.002</ixz><iyz>0.003</iyz></inertia></inertial></link>";
  const std::string text =
      "<sdf version='1.9'><model name='m'><pose>1 2 3 0.4 0.5 0.6</pose>"
      "<frame name='f' attached_to='b'><pose relative_to='g'>0 0.1 0.2 0 0.3 0</pose></frame>"
      "<frame name='g' attached_to='f2'><pose>0.3 0 0 0 0 1</pose></frame>"
      "<frame name='f2'><pose relative_to='j'>0 0 0.5 1 0 0</pose></frame>"
      "<link name='a'><pose>0.1 0.2 0.3 0 0 0.7</pose>" +
      body + "<link name='b'><pose relative_to='a'>0.5 0 0 0.2 0.4 0</pose>" + body +
      "<link name='c'><pose relative_to='f'>0 0 1 0 0 0</pose>" + body +
      "<joint name='w' type='fixed'><parent>world</parent><child>a</child></joint>"
      "<joint name='j' type='revolute'><pose>-0.2 0.1 0 0 0.5 "
      "0</pose><parent>a</parent><child>b</child><axis>"
      "<xyz expressed_in='g'>1 2 3</xyz><limit><lower>-1</lower><upper>2</upper></limit></axis></joint>"
      "<joint name='k' type='revolute'><pose relative_to='b'>0.3 0 0 0 0 "
      "0</pose><parent>f</parent><child>c</child>"
      "<axis><xyz expressed_in='__model__'>0 1 0</xyz></axis></joint></model></sdf>";
  compare(text, read_robot_text(text, "m.sdf"));
}

}  // namespace
}  // namespace anholon::sdformat_test

#endif
