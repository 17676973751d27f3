// SPDX-License-Identifier: GPL-2.0-or-later

// Model files that stand on SDFormat and MJCF files, as they do on URDF files.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "describe/read_model.hpp"

namespace anholon::supplement_test {
namespace {

namespace fs = std::filesystem;

class RobotSupplement : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / "anholon_robot_supplement";
    fs::create_directories(folder_);
    for (const char* name : {"arm.urdf", "arm.sdf", "arm.xml"})
      fs::copy_file(fs::path(ANHOLON_SOURCE_DIR) / "tests" / "robot_files" / name, folder_ / name,
                    fs::copy_options::overwrite_existing);
  }
  void TearDown() override { fs::remove_all(folder_); }
  Model read(const std::string& keys) {
    const std::string text = "anholon = 1\n" + keys +
                             "\n[parameters]\nk = { value = 80, unit = 'N m', meaning = 'spring' }\n"
                             "[[joint]]\nname = 'elbow'\ndrive = 'passive'\nstiffness = 'k'\n";
    return read_model_text(text, (folder_ / "robot.toml").string());
  }
  std::string fault(const std::string& keys) {
    try {
      read(keys);
      return "";
    } catch (const ModelError& error) {
      return error.diagnostics().front().fact + "; " + error.diagnostics().front().mend;
    }
  }
  fs::path folder_;
};

TEST_F(RobotSupplement, StandsOnEachFormat) {
  for (const char* key : {"urdf = 'arm.urdf'", "sdf = 'arm.sdf'", "mjcf = 'arm.xml'"}) {
    const Model model = read(key);
    EXPECT_EQ(model.coordinates.size(), 4U) << key;
    EXPECT_EQ(model.coordinates[1].drive, Drive::passive) << key;
    EXPECT_FALSE(model.potential.is_zero()) << key;
  }
}

TEST_F(RobotSupplement, AddsToArmatures) {
  const Model model =
      read_model_text("anholon = 1\nmjcf = 'arm.xml'\n[[joint]]\nname = 'elbow'\narmature = 0.25\n",
                      (folder_ / "robot.toml").string());
  for (const BodyDescription& b : model.bodies) {
    const Expr& armature = b.joint.armature;
    EXPECT_TRUE(b.joint.coordinate == "elbow" ? armature.constant_value()->to_double() == 0.25
                                              : armature.is_zero());
  }
}

TEST_F(RobotSupplement, HasExactMessages) {
  EXPECT_EQ(
      fault("sdf = 'arm.urdf'"),
      "the file is of the format URDF, not SDFormat; name it by the key of its format: urdf, sdf or mjcf");
  EXPECT_EQ(fault("sdf = 'arm.sdf'\nmjcf = 'arm.xml'"),
            "the description stands on two files, 'sdf' and 'mjcf'; name one");
  EXPECT_EQ(
      fault("mjcf = 'leg.xml'"),
      "'leg.xml' is not a MJCF file; name a file ending in .urdf, .sdf, .mjcf or .xml, relative to this one");
}

}  // namespace
}  // namespace anholon::supplement_test
