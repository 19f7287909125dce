#include "kinecal/files/results/transform_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/parameters/parameter_table.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// A flange, and a camera on it or beside it; the camera's joint is calibrated by half a turn about z.
std::map<std::string, std::string> files(bool on_hand, bool has_poses = true) {
  const Robot robot("r", {{"flange_joint", JointType::floating, "base", "flange", {}},
                          {"camera_joint",
                           JointType::fixed,
                           on_hand ? "flange" : "base",
                           "my camera",
                           {Matrix3<double>::Identity(), {0.0, 0.25, 0.0}}}});
  ParameterTable table;
  for (const auto axis : kFrameAxes) table.add({.name = parameter_name("camera_joint", axis)});
  table["camera_joint_x"].value = 0.5;
  table["camera_joint_c"].value = 3.14159265358979323846;
  std::vector<Sample> samples(2);
  if (has_poses) samples[1].poses["flange_joint"] = {};
  std::map<std::string, std::string> all;
  for (const OutputFile& file : transform_files(robot, table, samples)) {
    all[file.name] = file.content;
  }
  return all;
}

TEST(TransformFiles, HaveThePoseOfTheCameraInEachForm) {
  const auto all = files(true);
  ASSERT_EQ(all.size(), 7u);
  EXPECT_THAT(all.at("camera_joint.sh"),
              HasSubstr("ros2 run tf2_ros static_transform_publisher --x 0.5 --y 0.25 --z 0 "));
  EXPECT_THAT(all.at("camera_joint.sh"),
              HasSubstr("--frame-id flange --child-frame-id 'my camera'"));
  EXPECT_THAT(all.at("camera_joint.launch.py"), HasSubstr("\"--child-frame-id\""));
  EXPECT_THAT(all.at("camera_joint.launch.py"), HasSubstr("\"my camera\"]"));
  EXPECT_THAT(all.at("camera_joint.txt"), HasSubstr("0 0 0 1\n"));
  EXPECT_THAT(all.at("camera_joint.txt"), testing::StartsWith("-1 "));
  EXPECT_THAT(all.at("camera_joint.launch"), HasSubstr("flange 'my camera'\"/>"));
  EXPECT_THAT(all.at("camera_joint.calib"), HasSubstr("calibration_type: eye_in_hand"));
  EXPECT_THAT(files(false).at("camera_joint.calib"), HasSubstr("calibration_type: eye_on_base"));
  EXPECT_THAT(all.at("camera_joint.easy_handeye.yaml"), HasSubstr("eye_on_hand: true"));
  EXPECT_THAT(all.at("camera_joint.easy_handeye.yaml"), HasSubstr("robot_effector_frame: flange"));
  EXPECT_THAT(files(false).at("camera_joint.easy_handeye.yaml"), HasSubstr("eye_on_hand: false"));
}

TEST(TransformFiles, TheJointIsOneOfAUrdf) {
  const std::string urdf = "<robot name='r'><link name='flange'/><link name='my camera'/>" +
                           files(true).at("camera_joint.xml") + "</robot>";
  const Joint joint = parse_urdf(urdf, "r.urdf").joint("camera_joint");
  EXPECT_EQ(joint.parent, "flange");
  EXPECT_EQ(joint.origin.translation, Vector3<double>(0.5, 0.25, 0.0));
  EXPECT_NEAR(joint.origin.rotation(0, 0), -1.0, 1e-15);
}

TEST(TransformFiles, ThereAreNoneWithoutMeasuredPoses) {
  EXPECT_THAT(files(true, false), IsEmpty());
}

}  // namespace
}  // namespace kinecal
