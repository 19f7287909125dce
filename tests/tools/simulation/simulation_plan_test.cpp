#include "kinecal/tools/simulation/simulation_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/paths.hpp"
#include "support/repetitions.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Robot example_robot(const std::string& path) {
  return read_urdf(test::source_folder() + "/examples/" + path);
}

SimulationPlan plan_of(const Robot& robot, const std::string& target) {
  Diagnostics diagnostics;
  SimulationPlan plan = read_simulation(robot, "", target, 1, diagnostics);
  EXPECT_TRUE(diagnostics.errors.empty()) << diagnostics.errors.front();
  return plan;
}

/// A plan from the text of a scene; and its errors.
std::pair<SimulationPlan, Diagnostics> plan_of_text(const std::string& text) {
  const test::TemporaryFolder folder;
  const std::string path = (folder.path() / "scene.yaml").string();
  std::ofstream(path) << text;
  Diagnostics diagnostics;
  SimulationPlan plan =
      read_simulation(example_robot("robots/fetch/fetch.urdf"), path, "", 0, diagnostics);
  return {std::move(plan), std::move(diagnostics)};
}

TEST(SimulationPlan, EachShippedRobotWithACameraHasOne) {
  const std::vector<std::string> targets = {"leds", "checkerboard", "ground"};
  for (const std::string urdf :
       {"robots/fetch/fetch.urdf", "robots/ubr1/ubr1.urdf", "robots/pr2/pr2.urdf",
        "robots/panda/panda.urdf", "robots/tiago/tiago.urdf",
        "mobile_manipulator/mobile_manipulator.urdf"}) {
    const Robot robot = example_robot(urdf);
    const bool on_hand = urdf.find("panda") != std::string::npos;
    const int first = on_hand ? 1 : 0, end = on_hand ? 2 : test::repetitions(3, 1);
    for (int t = first; t < end; ++t) {
      const std::string& target = targets[static_cast<std::size_t>(t)];
      SimulationPlan plan = plan_of(robot, target);
      plan.poses = 5;
      EXPECT_GE(plan.setup.truth.size(), 8) << urdf << " " << target;
      EXPECT_FALSE(poses_of(plan).empty()) << urdf << " " << target;
      const SimulatedRobot simulated(plan.setup);
      EXPECT_GT(simulated.in_camera(plan.target.link).translation.norm(), 0.0);
    }
  }
}

TEST(SimulationPlan, ARobotThatIsItsOwnTargetNeedsASurfaceThatMovesAgainstItsCamera) {
  const Robot robot = example_robot("robots/fetch/fetch.urdf");
  Diagnostics diagnostics;
  const auto plan_with = [&](const RobotSurface& surface) {
    return read_simulation(robot, "", "robot", 1, diagnostics, nullptr, [&] { return surface; });
  };
  const auto error_of = [&](const auto& make) -> std::string {
    try {
      static_cast<void>(make());
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(error_of([&] { return read_simulation(robot, "", "robot", 1, diagnostics); }),
              HasSubstr("target 'robot' is simulated by 'kinecal simulate'"));
  const TriangleTree tree({{-0.1, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0.1}}, {{0, 1, 2}});
  EXPECT_THAT(error_of([&] {
                return plan_with(RobotSurface({{"head_tilt_link", tree}}));
              }),
              HasSubstr("no link that moves against the camera"));
  // The camera looks out of its own housing, and at the outermost link of the arm that has a surface.
  const RobotSurface surface({{"head_camera_rgb_frame", tree},
                              {"base_link", tree},
                              {"forearm_roll_link", tree},
                              {"elbow_flex_link", tree}});
  const SimulationPlan plan = plan_with(surface);
  EXPECT_EQ(plan.target.link, "forearm_roll_link");
  EXPECT_EQ(plan.setup.scene.solids.size(), 3U);
  EXPECT_EQ(plan.camera_type, "camera3d");
  EXPECT_THAT(plan.config, AllOf(HasSubstr("chain3d_to_mesh"), HasSubstr("- elbow_flex_joint")));
  EXPECT_GE(plan.setup.truth.find("elbow_flex_joint"), 0);
}

TEST(SimulationPlan, ACameraOnTheHandLooksAtABoardThatStands) {
  const SimulationPlan plan = plan_of(example_robot("robots/panda/panda.urdf"), "");
  EXPECT_EQ(plan.target.link, "panda_link0");
  EXPECT_EQ(plan.setup.truth["checkerboard_z"].value, plan.target.pose.translation.z());
  EXPECT_TRUE(plan.setup.frames.contains("camera_color_joint"));
  EXPECT_EQ(plan.target_frame, "checkerboard");
}

TEST(SimulationPlan, EachLedOfFetchLightsWhereItIs) {
  SimulationPlan plan = plan_of(example_robot("robots/fetch/fetch.urdf"), "leds");
  plan.poses = 3;
  SimulatedRobot robot(plan.setup);
  int seen = 0;
  for (const JointTarget& pose : poses_of(plan)) {
    robot.move(pose);
    robot.wait_for_rest();
    const GrayImage dark = robot.next_view(robot.light(0)).image;
    for (std::size_t i = 0; i < plan.target.leds.size(); ++i) {
      const GrayImage lit = robot.next_view(robot.light(static_cast<int>(i) + 1)).image;
      const Eigen::Vector2d pixel =
          robot.lens().project(robot.in_camera(plan.target.link) * plan.target.leds[i]);
      const int u = static_cast<int>(std::lround(pixel.x()));
      const int v = static_cast<int>(std::lround(pixel.y()));
      if (!lit.contains(u, v)) continue;  // the true robot looks elsewhere than its URDF
      EXPECT_GT(lit(u, v) - dark(u, v), 80) << "LED " << i + 1;
      ++seen;
    }
  }
  EXPECT_GE(seen, 9);
}

TEST(SimulationPlan, AScenesWordsAreTaken) {
  const auto [plan, diagnostics] = plan_of_text(R"(
seed: 7
camera: {name: eye, type: camera3d, blur: 1.5, image: rectified, holes: false}
target: {type: leds, link: gripper_link, xyz: [0, 0, 0.04], rpy: [3.14159265, 0, 0],
         leds: [[0, 0, 0.04], [0.02, 0, 0.04]]}
errors: {joint: 0.01, values: {elbow_flex_joint: 0.2, torso_lift_joint: 0.01, eye_fx: 0.0}}
motion: {speed: 0.5, backlash: 0.001}
faults: {dark_led: 2, views_end: 12.5}
poses: 4
)");
  ASSERT_TRUE(diagnostics.errors.empty()) << diagnostics.errors.front();
  EXPECT_EQ(plan.setup.seed, 7U);
  EXPECT_EQ(plan.setup.camera.blur, 1.5);
  EXPECT_FALSE(plan.setup.camera.has_holes);
  EXPECT_EQ(plan.setup.truth["elbow_flex_joint"].value, 0.2);
  EXPECT_EQ(plan.setup.truth["torso_lift_joint"].value, 0.01);
  EXPECT_EQ(plan.setup.truth["eye_fx"].value, 0.0);
  EXPECT_LE(std::abs(plan.setup.truth["wrist_flex_joint"].value), 0.01);
  EXPECT_GE(std::abs(plan.setup.truth["wrist_flex_joint"].value), 0.005);
  EXPECT_EQ(plan.setup.timing.backlash, 0.001);
  EXPECT_EQ(plan.setup.faults.dark_led, 2);
  EXPECT_EQ(plan.setup.faults.views_end, 12.5);
  EXPECT_EQ(plan.target.leds.size(), 2U);
  EXPECT_EQ(plan.poses, 4);
  EXPECT_EQ(plan.goal.points.size(), 2U);
}

TEST(SimulationPlan, WrongWordsAreErrorsWithTheirLines) {
  const std::string text =
      "camera: {tpye: camera3d}\ntarget: {type: led}\nerrors: {joint: wide}\n"
      "motion: {speed: -1}\nfaults: {dark_led: none}\nposes: 0.5\n";
  const Diagnostics diagnostics = plan_of_text(text).second;
  std::string all;
  for (const std::string& error : diagnostics.errors) all += error + "\n";
  EXPECT_THAT(all, HasSubstr("scene.yaml:1: camera: unknown key 'tpye'; did you mean 'type'?"));
  EXPECT_THAT(all, HasSubstr("scene.yaml:2: target: type is 'led', not one of leds,"));
  for (int line = 3; line <= 6; ++line) {
    EXPECT_THAT(all, HasSubstr("scene.yaml:" + std::to_string(line) + ": "));
  }
  EXPECT_THAT(plan_of_text("errors: {values: {elbow_flx_joint: 1}}").second.errors.at(0),
              HasSubstr("did you mean 'elbow_flex_joint'?"));
  EXPECT_THAT(plan_of_text("target: {type: leds, leds: []}").second.errors.at(0),
              HasSubstr("leds is empty; give the point of at least one LED"));
  EXPECT_THAT(plan_of_text("seed: 1\nerrors: {joint: 3}").second.errors.at(0),
              HasSubstr("scene.yaml:2: errors: joint is 3, not between 0 and 1"));
}

TEST(SimulationPlan, ALinkThatDoesNotExistIsNamed) {
  for (const char* text :
       {"camera: {frame: head_camera_rgb_optical_fram}", "target: {link: gripper_lnk}"}) {
    EXPECT_THAT(plan_of_text(text).second.errors.at(0),
                AllOf(HasSubstr("scene.yaml:1: "), HasSubstr("did you mean")));
  }
}

}  // namespace
}  // namespace kinecal
