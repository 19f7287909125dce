#include "kinecal/capture/session/robot_body.hpp"

#include <gtest/gtest.h>

#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/robots.hpp"

namespace kinecal {
namespace {

TEST(RobotBody, PosesAreThoseOfForwardKinematics) {
  const Robot robot = test::mobile_manipulator();
  for (const char* base : {"base_link", "torso"}) {
    const RobotBody body(robot, base, 0.05);
    std::vector<double> q;
    for (std::size_t i = 0; i < body.joints().size(); ++i) q.push_back(0.1 + 0.13 * double(i));
    const auto position_of = [&](const std::string& joint) {
      for (std::size_t i = 0; i < q.size(); ++i) {
        if (body.joints()[i] == joint) return q[i];
      }
      return 0.0;
    };
    const std::vector<Pose<double>> poses = body.poses(q);
    for (const char* tip : {"hand", "finger_right", "counterweight", "camera_optical_frame"}) {
      const Pose<double> expected =
          forward_kinematics(make_chain(robot, base, tip, {}), position_of);
      EXPECT_TRUE(poses[body.link(tip)].rotation.isApprox(expected.rotation, 1e-12)) << tip;
      EXPECT_NEAR((poses[body.link(tip)].translation - expected.translation).norm(), 0, 1e-12);
    }
  }
  EXPECT_THROW(static_cast<void>(RobotBody(robot, "base_link", 0.05).link("hnd")), RobotError);
}

/// Three links of 0.5 m in a plane, and a post with a tip beside the first joint.
Robot planar_arm() {
  using enum JointType;
  return Robot("planar", {{"a", continuous, "base", "one", {}, {0, 0, 1}},
                          {"b", continuous, "one", "two", test::origin({0.5, 0, 0}), {0, 0, 1}},
                          {"c", continuous, "two", "three", test::origin({0.5, 0, 0}), {0, 0, 1}},
                          {"end", fixed, "three", "tip", test::origin({0.5, 0, 0})},
                          {"stand", fixed, "base", "post", test::origin({0.0, 0.2, 0.0})}});
}

TEST(RobotBody, TouchesItselfWhereItsLinksCross) {
  const RobotBody body(planar_arm(), "base", 0.03);
  const auto touches = [&](double b, double c) {
    return body.touches_itself(body.poses(std::vector<double>{0.0, b, c}));
  };
  EXPECT_FALSE(touches(0.0, 0.0));
  EXPECT_FALSE(touches(1.5, 1.5));
  EXPECT_TRUE(touches(2.2, 2.2));    // the last link crosses the first
  EXPECT_FALSE(touches(2.2, -2.2));  // away from it
}

TEST(RobotBody, HidesALineOfSight) {
  const RobotBody body(planar_arm(), "base", 0.03);
  const std::size_t base = body.link("base"), tip = body.link("tip");
  const auto hides = [&](double b) {
    const std::vector<Pose<double>> poses = body.poses(std::vector<double>{0.0, b, 0.0});
    return body.hides(poses, base, {0.75, -0.5, 0.0}, tip, {0.75, 0.5, 0.0});
  };
  EXPECT_FALSE(hides(1.5));
  EXPECT_TRUE(RobotBody(planar_arm(), "base", 0.03)
                  .hides(body.poses(std::vector<double>{0.0, 0.0, 1.5}), base, {0.75, -0.5, 0.0},
                         body.link("post"), {0.75, 0.5, 0.0}));
}

TEST(RobotBody, IsBelowAHeightWithItsMovingLinksOnly) {
  const RobotBody body(test::mobile_manipulator(), "torso", 0.05);
  const std::vector<Pose<double>> poses = body.poses(std::vector<double>(body.joints().size()));
  EXPECT_FALSE(body.is_below(poses, -2.0));
  EXPECT_TRUE(body.is_below(poses, 0.7));
}

}  // namespace
}  // namespace kinecal
