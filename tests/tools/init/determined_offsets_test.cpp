#include "kinecal/tools/init/determined_offsets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "kinecal/geometry/rotation.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A slide, then an arm of six joints with a reflector.
class SlideAndArm {
 public:
  /// @param axis   of the slide
  /// @param range  of the slide, metres
  SlideAndArm(const Vector3<double>& axis, double range) {
    add("slide", JointType::prismatic, axis);
    joints_.back().limits = JointLimits{0.0, range};
    const Vector3<double> x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    int number = 0;
    for (const Vector3<double>& turn : {z, y, y, x, y, x}) {
      add("j" + std::to_string(++number), JointType::revolute, turn);
      joints_.back().origin.translation = {0.1, 0.0, 0.3};
      joints_.back().limits = JointLimits{-1.5, 1.5};
    }
  }

  Joint& joint(std::size_t i) { return joints_[i]; }
  void add(const std::string& name, JointType type, const Vector3<double>& axis) {
    Joint joint;
    joint.name = name;
    joint.type = type;
    joint.parent = joints_.empty() ? "base" : joints_.back().child;
    joint.child = name + "_link";
    joint.axis = axis;
    joints_.push_back(joint);
  }

  /// Joints whose offsets a tracker determines.
  [[nodiscard]] std::vector<std::string> freed() const {
    std::vector<std::string> names;
    for (const OffsetEffect& effect : effects().offsets) {
      if (effect.determined) names.push_back(effect.joint);
    }
    return names;
  }
  [[nodiscard]] OffsetEffects effects() const {
    const Robot robot("r", joints_);
    MeasuredTarget measured{"base", joints_.back().child, "base"};
    measured.target_frame = "smr";
    measured.is_point = true;
    measured.sensor_frame = "tracker";
    return offset_effects(robot, measured, {}, driven_joints(robot, measured));
  }

 private:
  std::vector<Joint> joints_;
};

const Vector3<double> kX(1.0, 0.0, 0.0), kZ(0.0, 0.0, 1.0);

TEST(DeterminedOffsets, AfterARailIncludeTheFirstTurn) {
  EXPECT_THAT(SlideAndArm(kX, 2.0).freed(), ElementsAre("j1", "j2", "j3", "j4", "j5"));
  EXPECT_THAT(SlideAndArm(kX, 0.05).freed(), ElementsAre("j1", "j2", "j3", "j4", "j5"));
}

TEST(DeterminedOffsets, AfterAParallelLiftDoNotIncludeTheFirstTurn) {
  const OffsetEffects effects = SlideAndArm(kZ, 0.5).effects();
  EXPECT_THAT(SlideAndArm(kZ, 0.5).freed(), ElementsAre("j2", "j3", "j4", "j5"));
  EXPECT_EQ(effects.offsets[0].imitated_by, "tracker");
  EXPECT_EQ(effects.offsets[1].imitated_by, "tracker");
  EXPECT_EQ(effects.offsets[6].imitated_by, "smr");
  EXPECT_TRUE(effects.frames_determined);
}

TEST(DeterminedOffsets, AfterALiftBeforeATiltedShoulderIncludeTheFirstTurn) {
  SlideAndArm arm(kZ, 0.4);
  arm.joint(1).origin.rotation = exp(Vector3<double>(0.3, 0.0, 0.0));
  EXPECT_THAT(arm.freed(), ElementsAre("j1", "j2", "j3", "j4", "j5"));
}

TEST(DeterminedOffsets, TakeAxesThatAreRoundedForParallel) {
  SlideAndArm arm(kX, 0.5);
  arm.joint(1).origin.rotation = exp(Vector3<double>(0.0, 1.5708, 0.0));
  EXPECT_THAT(arm.freed(), ElementsAre("j2", "j3", "j4", "j5"));
}

TEST(DeterminedOffsets, OfAJointThatOthersMimicAreThoseOfAll) {
  SlideAndArm arm(kZ, 0.5);
  arm.joint(3).mimic = Mimic{"j1", 1.0, 0.0};
  EXPECT_THAT(arm.freed(), ElementsAre("j1", "j2", "j4", "j5"));
  arm.joint(3).mimic = Mimic{"slide", 1.0, 0.0};
  EXPECT_THAT(arm.freed(), ElementsAre("slide", "j2", "j4", "j5"));
}

TEST(DeterminedOffsets, LeaveAPriorForFramesWhereAllAxesAreParallel) {
  SlideAndArm arm(kZ, 0.5);
  for (std::size_t i = 1; i <= 6; ++i) arm.joint(i).axis = kZ;
  EXPECT_FALSE(arm.effects().frames_determined) << "the height of the reflector";
}

TEST(DeterminedOffsets, AreNoneOfAJointThatMovesTargetAndCameraAlike) {
  SlideAndArm arm(kZ, 0.5);
  arm.add("camera_mount", JointType::fixed, kX);
  Joint camera = arm.joint(7);
  camera.name = "camera_joint";
  camera.parent = "slide_link";
  camera.child = "camera";
  camera.origin = {exp(Vector3<double>(0.0, std::numbers::pi / 2.0, 0.0)), {0.0, 0.0, 1.0}};
  std::vector<Joint> all;
  for (const char* name : {"odom_x", "odom_turn"}) {  // a base that drives anywhere
    Joint odometry;
    odometry.name = name;
    odometry.type = all.empty() ? JointType::prismatic : JointType::continuous;
    odometry.parent = all.empty() ? "odom" : "odom_x_link";
    odometry.child = all.empty() ? "odom_x_link" : "base";
    odometry.axis = all.empty() ? kX : kZ;
    odometry.limits = JointLimits{-500.0, 500.0};
    all.push_back(odometry);
  }
  for (std::size_t i = 0; i < 7; ++i) all.push_back(arm.joint(i));
  all.push_back(camera);
  const Robot robot("r", all);
  MeasuredTarget measured{"odom", "j6_link", "camera"};
  measured.is_camera = true;
  const OffsetEffects effects =
      offset_effects(robot, measured, {"camera_joint"}, driven_joints(robot, measured));
  for (std::size_t i = 0; i < 3; ++i) {  // odometry and the slide
    EXPECT_FALSE(effects.offsets[i].is_seen) << effects.offsets[i].joint;
  }
  EXPECT_EQ(effects.offsets[3].imitated_by, "camera_joint");
  EXPECT_TRUE(effects.offsets[8].determined) << "points at known places";
}

}  // namespace
}  // namespace kinecal
