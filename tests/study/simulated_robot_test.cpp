#include "kinecal/study/simulated_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "support/robots.hpp"

namespace kinecal {
namespace {

using std::chrono::milliseconds;

/// A head camera, and a turntable in front of it with two LEDs.
Robot turntable() {
  using enum JointType;
  const double half_pi = std::numbers::pi / 2;
  Joint table{"table", revolute, "base", "plate", test::origin({1.0, 0.0, 0.3}), {0, 0, 1}};
  table.limits = JointLimits{-1.0, 1.0};
  return Robot(
      "turntable",
      {table,
       {"neck", revolute, "base", "head", test::origin({0, 0, 0.5}), {0, 1, 0}},
       {"eye", fixed, "head", "optical", test::origin({0.05, 0, 0}, {-half_pi, 0, -half_pi})}});
}

SimulatedSetup turntable_setup() {
  SimulatedSetup setup;
  setup.robot = turntable();
  setup.base = "base";
  setup.camera.frame = "optical";
  add_ground(setup.scene, -0.5);
  add_box(setup.scene, "plate", {Matrix3<double>::Identity(), {0, 0, 0.1}}, {0.1, 0.1, 0.2});
  add_leds(setup.scene, "plate", {{-0.0501, 0.03, 0.15}, {-0.0501, -0.03, 0.12}}, {-1, 0, 0});
  return setup;
}

/// Moves and waits for the end.
MeasuredJoints moved(SimulatedRobot& robot, const JointTarget& target) {
  robot.move(target);
  robot.wait_for_rest();
  return robot.next_joints(robot.now());
}

TEST(SimulatedRobot, JointsArriveWithinTheirSpeed) {
  SimulatedRobot robot(turntable_setup());
  const Stamp start = robot.now();
  robot.move({{"table"}, {0.8}});
  MeasuredJoints joints = robot.next_joints(start + milliseconds(300));
  EXPECT_GT(*joints.position("table"), 0.02);
  EXPECT_LT(*joints.position("table"), 0.3);
  EXPECT_EQ(joints.stamp, milliseconds(310));  // the first of 100 Hz after it
  joints = moved(robot, {{"table"}, {0.8}});
  EXPECT_NEAR(*joints.position("table"), 0.8, 2e-4);
  EXPECT_GT(robot.now(), joints.stamp - milliseconds(1));
}

TEST(SimulatedRobot, ImagesComeLateWithTheStampOfTheirExposure) {
  SimulatedSetup setup = turntable_setup();
  setup.timing.image_latency = 0.5;
  SimulatedRobot robot(setup);
  const View view = robot.next_view(milliseconds(1000));
  EXPECT_GT(view.stamp, milliseconds(1000));
  EXPECT_LE(view.stamp, milliseconds(1067));
  EXPECT_EQ(robot.now(), view.stamp + milliseconds(500));
}

TEST(SimulatedRobot, ViewsShowLedsWhereTheTrueRobotHasThem) {
  SimulatedSetup setup = turntable_setup();
  setup.truth.add({.name = "neck", .value = 0.03});
  setup.truth.add({.name = "eye_y", .value = 0.01});
  setup.truth.add({.name = "camera_fx", .value = 0.02});
  setup.frames = {"eye"};
  setup.camera.noise = 0.0;
  SimulatedRobot robot(setup);
  static_cast<void>(moved(robot, {{"table", "neck"}, {0.2, 0.2}}));
  const View dark = robot.next_view(robot.light(0)), lit = robot.next_view(robot.light(2));
  Eigen::Vector3d sum(0, 0, 0);
  for (int v = 0; v < dark.image.height; ++v) {
    for (int u = 0; u < dark.image.width; ++u) {
      sum += (lit.image(u, v) - dark.image(u, v)) * Eigen::Vector3d(u, v, 1);
    }
  }
  ASSERT_GT(sum.z(), 1000.0);
  const Vector3<double> led = robot.in_camera("plate") * Vector3<double>(-0.0501, -0.03, 0.12);
  const Eigen::Vector2d expected = robot.lens().project(led);
  EXPECT_NEAR((sum.head<2>() / sum.z() - expected).norm(), 0.0, 0.1);
  // The URDF's own robot has it elsewhere.
  setup.truth = {};
  SimulatedRobot nominal(setup);
  static_cast<void>(moved(nominal, {{"table", "neck"}, {0.2, 0.2}}));
  const Vector3<double> elsewhere =
      nominal.in_camera("plate") * Vector3<double>(-0.0501, -0.03, 0.12);
  EXPECT_GT((nominal.lens().project(elsewhere) - expected).norm(), 5.0);
}

/// Sum of squared differences between neighbours in a column.
double sharpness(const GrayImage& image) {
  double sum = 0.0;
  for (int v = 1; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const double step = int{image(u, v)} - int{image(u, v - 1)};
      sum += step * step;
    }
  }
  return sum;
}

TEST(SimulatedRobot, APhotographOfWhatMovesIsBlurredByItsExposure) {
  SimulatedSetup setup = turntable_setup();
  setup.camera.noise = 0.0;
  SimulatedRobot quick(setup);
  setup.timing.exposure = 0.02;
  SimulatedRobot slow(setup);
  for (SimulatedRobot* robot : {&quick, &slow}) robot->move({{"neck"}, {0.5}});
  const auto views_at = [&](Stamp after) {
    return std::pair{quick.next_view(after), slow.next_view(after)};
  };
  const auto [sharp, blurred] = views_at(milliseconds(400));
  ASSERT_EQ(sharp.stamp, blurred.stamp);
  EXPECT_LT(sharpness(blurred.image), 0.5 * sharpness(sharp.image));
  EXPECT_GT(sharpness(blurred.image), 0.0);
  for (SimulatedRobot* robot : {&quick, &slow}) robot->wait_for_rest();
  const auto [still, as_still] = views_at(quick.now() + milliseconds(50));
  EXPECT_EQ(still.image.pixels, as_still.image.pixels);
}

TEST(SimulatedRobot, AnLedThatIsSwitchedDuringAnExposureIsDimmer) {
  SimulatedSetup setup = turntable_setup();
  setup.camera.noise = 0.0;
  setup.timing.exposure = 0.05;
  SimulatedRobot robot(setup);
  const auto brightest = [](const View& dark, const View& view) {
    int most = 0;
    for (std::size_t i = 0; i < view.image.pixels.size(); ++i) {
      most = std::max(most, view.image.pixels[i] - dark.image.pixels[i]);
    }
    return most;
  };
  const View dark = robot.next_view(robot.light(0));
  const Stamp lit = robot.light(1);
  const View first = robot.next_view(lit), second = robot.next_view(first.stamp);
  ASSERT_LT(first.stamp, lit + milliseconds(50));
  EXPECT_LT(brightest(dark, first), brightest(dark, second));
}

TEST(SimulatedRobot, IsTheSameForTheSameSeed) {
  SimulatedRobot a(turntable_setup()), b(turntable_setup());
  EXPECT_EQ(a.next_view(Stamp(0)).image.pixels, b.next_view(Stamp(0)).image.pixels);
  EXPECT_EQ(a.next_joints(Stamp(0)).positions, b.next_joints(Stamp(0)).positions);
}

TEST(SimulatedRobot, BacklashDependsOnTheDirection) {
  SimulatedSetup setup = turntable_setup();
  setup.timing.backlash = 0.01;
  setup.timing.repeatability = setup.timing.encoder_noise = 0.0;
  SimulatedRobot robot(setup);
  static_cast<void>(moved(robot, {{"table"}, {0.5}}));
  EXPECT_NEAR(robot.true_positions().at("table"), 0.5 - 0.005, 1e-9);
  static_cast<void>(moved(robot, {{"table"}, {0.9}}));
  const MeasuredJoints joints = moved(robot, {{"table"}, {0.5}});
  EXPECT_NEAR(robot.true_positions().at("table"), 0.5 + 0.005, 1e-9);
  EXPECT_NEAR(*joints.position("table"), 0.5, 1e-9);
}

TEST(SimulatedRobot, RefusesWhatAJointCannotDo) {
  SimulatedRobot robot(turntable_setup());
  EXPECT_THROW(robot.move({{"table"}, {1.2}}), PoseError);
  EXPECT_THROW(robot.move({{"tabel"}, {0.2}}), PoseError);
  EXPECT_THROW(robot.move({{"table"}, {}}), PoseError);
  EXPECT_THROW(robot.move({{"table"}, {0.1}, 0.0}), PoseError);
  SimulatedSetup setup = turntable_setup();
  setup.scene.patches[0].link = "nowhere";
  EXPECT_THROW(SimulatedRobot{setup}, RobotError);
}

TEST(SimulatedRobot, FaultsHappen) {
  SimulatedSetup setup = turntable_setup();
  setup.faults.stuck_joint = "table";
  setup.faults.dark_led = 1;
  setup.faults.no_camera_info = true;
  setup.faults.other_clock = 100.0;
  setup.faults.views_end = 20.0;
  setup.faults.joints_end = 30.0;
  setup.faults.connection_ends = 40.0;
  setup.camera.noise = 0.0;
  SimulatedRobot robot(setup);
  EXPECT_NEAR(*moved(robot, {{"table"}, {0.8}}).position("table"), 0.4, 1e-3);
  const View dark = robot.next_view(robot.light(0)), lit = robot.next_view(robot.light(1));
  EXPECT_EQ(dark.image.pixels, lit.image.pixels);
  EXPECT_FALSE(lit.camera);
  EXPECT_GT(lit.stamp, milliseconds(100'000));
  EXPECT_THROW(static_cast<void>(robot.next_view(milliseconds(120'100))), PoseError);
  for (int i = 0; i < 10; ++i) {
    try {
      static_cast<void>(robot.next_joints(robot.now()));
      robot.light(0);
    } catch (const PoseError&) {
    }
  }
  EXPECT_THROW(static_cast<void>(robot.next_joints(milliseconds(30'100))), PoseError);
  for (int i = 0; i < 1000; ++i) {
    try {
      static_cast<void>(robot.next_joints(milliseconds(30'100)));
    } catch (const PoseError&) {
    } catch (const ConnectionError&) {
      return;
    }
  }
  FAIL() << "the connection did not end";
}

TEST(SimulatedRobot, OutliersAreNotSeenByEncoders) {
  SimulatedSetup setup = turntable_setup();
  setup.faults.outliers = 1.0;
  SimulatedRobot robot(setup);
  const MeasuredJoints joints = moved(robot, {{"table"}, {0.3}});
  EXPECT_NEAR(*joints.position("table"), 0.3, 1e-3);
  EXPECT_NEAR(std::abs(robot.true_positions().at("table") - 0.3), 0.05, 1e-3);
}

TEST(SimulatedRobot, SomethingMayHideAPartOfTheImage) {
  SimulatedSetup setup = turntable_setup();
  setup.camera.noise = 0.0;
  SimulatedRobot plain(setup);
  setup.faults.passer_by = 1.0;
  SimulatedRobot robot(setup);
  EXPECT_NE(robot.next_view(Stamp(0)).image.pixels, plain.next_view(Stamp(0)).image.pixels);
}

}  // namespace
}  // namespace kinecal
