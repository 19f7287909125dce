// Which joint describes how a camera is mounted.
#include "kinecal/tools/init/camera_parts.ipp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "kinecal/geometry/rpy.hpp"
#include "kinecal/tools/init/initial_config.hpp"

namespace kinecal {
namespace {

const Pose<double> kNone = {}, kShift = {Matrix3<double>::Identity(), {0.0, 0.02, 0.1}},
                   kOptical = {rotation_from_rpy(Vector3<double>(-M_PI_2, 0.0, -M_PI_2)),
                               {0.0, 0.0, 0.0}};

/// A fixed joint, called as the link that it carries.
Joint fixed(const std::string& parent, const std::string& child, const Pose<double>& origin) {
  return {child + "_joint", JointType::fixed, parent, child, origin};
}

/// An arm of two joints with a flange `tool0`, and what hangs on it.
Robot arm_with(std::vector<Joint> more) {
  std::vector<Joint> joints = {{"lift", JointType::revolute, "base", "upper", kShift, {0, 1, 0}},
                               {"wrist", JointType::revolute, "upper", "hand", kShift, {0, 0, 1}},
                               fixed("hand", "tool0", kShift)};
  joints.insert(joints.end(), more.begin(), more.end());
  return Robot("arm", joints);
}

std::string mount(const std::vector<Joint>& more, const std::string& camera) {
  const Robot robot = arm_with(more);
  const Joint* joint = detail::camera_mount(robot, camera, {"base"});
  return joint == nullptr ? "" : joint->name;
}

TEST(CameraMount, AJointWithoutOriginIsTheCamerasAndNotTheFlangesBelowIt) {
  EXPECT_EQ(mount({fixed("tool0", "camera", kNone)}, "camera"), "camera_joint");
  EXPECT_EQ(mount({fixed("tool0", "eye", kNone)}, "eye"), "eye_joint") << "whatever its name";
  EXPECT_EQ(mount({fixed("tool0", "camera_optical", kOptical)}, "camera_optical"),
            "camera_optical_joint");
}

TEST(CameraMount, AnOpticalFrameOnlyTurnsAxes) {
  EXPECT_EQ(mount({fixed("tool0", "camera", kShift), fixed("camera", "camera_optical", kOptical)},
                  "camera_optical"),
            "camera_joint");
  EXPECT_EQ(mount({fixed("tool0", "camera", kNone), fixed("camera", "camera_optical", kOptical)},
                  "camera_optical"),
            "camera_joint");
}

TEST(CameraMount, WhereTheCameraHangsWithoutOriginComesBeforeDistancesInsideIt) {
  const std::vector<Joint> inside = {fixed("camera_screw", "camera", kShift),
                                     fixed("camera", "camera_color", kShift),
                                     fixed("camera", "camera_depth", kNone),
                                     fixed("camera_color", "camera_color_optical", kOptical)};
  std::vector<Joint> hung = inside, measured = inside;
  hung.push_back(fixed("tool0", "camera_screw", kNone));
  measured.push_back(fixed("tool0", "camera_screw", kShift));
  EXPECT_EQ(mount(hung, "camera_color_optical"), "camera_screw_joint");
  EXPECT_EQ(mount(measured, "camera_color_optical"), "camera_color_joint");
}

TEST(CameraMount, AnAdapterOrWhatCarriesMoreThanTheCameraIsNotTheCamera) {
  EXPECT_EQ(mount({fixed("tool0", "adapter", kShift), fixed("adapter", "camera", kNone)}, "camera"),
            "camera_joint");
  EXPECT_EQ(mount({fixed("tool0", "camera_bracket", kShift),
                   fixed("camera_bracket", "camera_optical", kOptical),
                   fixed("camera_bracket", "gripper", kShift)},
                  "camera_optical"),
            "camera_optical_joint");
}

TEST(CameraMount, AMovingJointIsTakenIfThereIsNoOther) {
  const Joint pan{"pan", JointType::revolute, "tool0", "camera", kShift, {0, 0, 1}};
  EXPECT_EQ(mount({pan}, "camera"), "pan");
  EXPECT_EQ(mount({pan, fixed("camera", "camera_optical", kOptical)}, "camera_optical"),
            "camera_optical_joint");
}

TEST(CameraMount, JointsThatLeadToAnotherLinkAreNotTheCameras) {
  const Robot robot = arm_with({fixed("tool0", "camera", kNone)});
  EXPECT_EQ(detail::camera_mount(robot, "camera", {"camera"}), nullptr);
}

TEST(CameraMount, IsFreedByAFirstConfigurationInsteadOfTheFlange) {
  const Robot robot = arm_with({fixed("tool0", "camera", kNone)});
  const std::string text = initial_config(
      robot, {InitTarget::world_checkerboard, false, "base", "", "camera", "camera2d", "camera"});
  EXPECT_NE(text.find("{name: camera_joint, x: true"), std::string::npos) << text;
  EXPECT_EQ(text.find("tool0_joint"), std::string::npos) << text;
}

}  // namespace
}  // namespace kinecal
