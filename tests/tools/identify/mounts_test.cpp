// Mounts that are not as the URDF says: of tools, boards, cameras and trackers.  Each is found in the axes that the samples
// determine, or named beside what it is inseparable from; without an error, nothing is freed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "kinecal/config/config_to_yaml.hpp"
#include "kinecal/tools/identify/robot_search.hpp"
#include "support/repetitions.hpp"
#include "support/spoiled_robot.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using test::assembled;

constexpr double kDegree = std::numbers::pi / 180.0;

/// Values of parameters by name.
using Errors = std::map<std::string, double>;

/// A robot, its configuration, and samples of the true robot.
struct Recording {
  Robot robot;
  Config config;
  std::vector<Sample> samples;

  [[nodiscard]] RobotSearch search() const { return search_robot(config, robot, samples); }
};

/// Moves measurements to where a robot with these errors measures them, with noise.
void measure(Recording& recording, const Errors& truth, unsigned seed) {
  const Config wide = with_all_candidates(recording.config, recording.robot, recording.samples);
  const auto make = [&] {
    return assembled(wide, recording.robot, recording.samples)
        .steps.front()
        .problem->without_samples();
  };
  const auto problem = make();
  ParameterTable table = problem->table();
  for (const auto& [parameter, value] : truth) table[parameter].value = value;
  const Eigen::VectorXd values = table.values();
  recording.samples = exact_samples(make, {values.data(), static_cast<std::size_t>(values.size())},
                                    recording.samples);
  SeededRandom random(seed);
  const std::set<std::string> measuring = measuring_sensors(*problem, recording.samples);
  for (Sample& sample : recording.samples) {
    std::vector<Observation>& seen = sample.observations;
    if (seen[1].sensor != "tracker") {
      sample = with_noise(sample, *problem, measuring, {.joint = 1e-5}, random);
      continue;
    }
    constexpr double kNoise = 1e-4;
    seen[0].features[0].point.setZero();
    seen[1].features[0].point += kNoise * random.normal_vector();
  }
}

/// A UR5e whose reflector a tracker measures.
/// @param is_known  the tracker is where the URDF says; else its pose is free
Recording tracked_arm(const Errors& truth, unsigned seed, bool is_known = true) {
  const std::string tracker_frame = is_known ? "tracker" : "tracker_frame";
  Recording recording{test::robot_kinds().front().robot(), {}, {}};
  Diagnostics diagnostics;
  recording.config = parse_config(R"(
base_link: base
models:
 - {name: arm, type: chain3d, frame: reflector}
 - {name: tracker, type: chain3d, frame: tracker}
free_frames:
 - {name: tracker_frame, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
error_blocks:
 - {name: tracking, type: chain3d_to_chain3d, model_a: arm, model_b: tracker}
)",
                                  "calibrate.yaml", diagnostics);
  EXPECT_THAT(diagnostics.errors, IsEmpty());
  if (is_known) recording.config.steps.front().free_frames.clear();
  SeededRandom random(seed);
  for (int i = 0; i < 60; ++i) {
    Sample& sample = recording.samples.emplace_back();
    for (const Joint& joint : recording.robot.joints()) {
      if (!moves(joint.type)) continue;
      sample.joint_names.push_back(joint.name);
      sample.joint_positions.push_back(random.uniform(-2.0, 2.0));
    }
    sample.observations = {{"arm", {{"reflector", Vector3<double>::Zero()}}},
                           {"tracker", {{tracker_frame, random.normal_vector()}}}};
  }
  measure(recording, truth, seed + 1);
  return recording;
}

/// A robot of the examples whose camera sees a board or tags; a mount or the board is held.
/// @param held   a frame that the configuration frees: a board's is where it is
Recording seen_board(std::size_t kind, const std::string& held, const Errors& truth,
                     unsigned seed) {
  const test::RobotKind& of = test::robot_kinds().at(kind);
  const test::SeenPoses& seen = test::SeenPoses::of(of);
  Recording recording{of.robot(), seen.config, {}};
  recording.samples.assign(seen.samples.begin(), seen.samples.begin() + 60);
  Errors all;
  for (const Parameter& p : seen.values) all[p.name] = p.value;
  StepConfig& step = recording.config.steps.front();
  for (FreeFrameConfig& frame : step.free_frames) {
    if (frame.name != held || recording.robot.has_joint(held)) continue;
    frame.axes = {};
    frame.is_fixed = true;
    for (const auto axis : kFrameAxes) {
      const std::string name = parameter_name(held, axis);
      step.initial_values.push_back({name, all.at(name), step.place});
    }
  }
  std::erase_if(step.free_frames, [&](const FreeFrameConfig& frame) {
    return !frame.is_fixed && frame.name == held;
  });
  for (const auto& [name, error] : truth) all[name] = error;
  measure(recording, all, seed);
  return recording;
}

/// The names of what was freed.
std::vector<std::string> freed(const RobotSearch& search) {
  std::vector<std::string> names;
  for (const ReportedSearchStep& step : reported(search).steps) {
    if (step.is_chosen && !step.freed.empty()) names.push_back(step.freed);
  }
  return names;
}

/// Whether a candidate was freed, or named as what explains the same as something that was.
bool is_named(const RobotSearch& search, const std::string& name) {
  const std::vector<ReportedSearchStep> steps = reported(search).steps;
  return std::any_of(steps.begin(), steps.end(), [&](const ReportedSearchStep& step) {
    const bool is_alike = std::find(step.alike.begin(), step.alike.end(), name) != step.alike.end();
    return step.is_chosen && (step.freed == name || is_alike);
  });
}

TEST(Mounts, AToolIsFoundInTheAxesThatAPointDetermines) {
  const Recording recording = tracked_arm({{"reflector_joint_x", 0.005}}, 3);
  const RobotSearch search = recording.search();
  EXPECT_THAT(freed(search), ElementsAre("frame of reflector_joint: x y z"));
  EXPECT_THAT(search_text(search),
              AllOf(HasSubstr("\n  frame of reflector_joint: x y z  5.03 mm "),
                    HasSubstr("either frame of reflector_joint: x y z or frame of tool0_joint: x "
                              "y z: samples like these do not separate them\n")));
  EXPECT_THAT(config_to_yaml(search.config, "", {}),
              HasSubstr(" - {name: reflector_joint, x: true, y: true, z: true, roll: false, pitch: "
                        "false, yaw: false}\n"));
  const CalibrationResult result =
      calibrate(assembled(search.config, recording.robot, recording.samples));
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.table["reflector_joint_x"].value, 0.005, 1e-4);
}

TEST(Mounts, AToolIsNamedWhicheverAxisIsWrong) {
  for (const char* axis : {"x", "y", "z"}) {
    const RobotSearch search =
        tracked_arm({{std::string("reflector_joint_") + axis, -0.005}}, 5, false).search();
    EXPECT_EQ(freed(search).size(), 1U) << axis;
    EXPECT_TRUE(is_named(search, "frame of reflector_joint: x y z")) << axis << "\n"
                                                                     << search_text(search);
  }
}

TEST(Mounts, AHeldAxisOfAMountStaysHeld) {
  const Recording recording = tracked_arm({{"reflector_joint_z", 0.005}}, 4);
  const SearchLimits limits{.hold = {"reflector_joint_x", "tool0_joint"}};
  const RobotSearch search =
      search_robot(recording.config, recording.robot, recording.samples, limits);
  EXPECT_THAT(freed(search), ElementsAre("frame of reflector_joint: y z"));
}

TEST(Mounts, AToolIsFoundBesideWrongZeros) {
  const std::string tool = "frame of reflector_joint: x y z";
  Errors truth = {{"elbow_joint", 0.01}, {"wrist_1_joint", -0.006}};
  EXPECT_THAT(freed(tracked_arm(truth, 6).search()), testing::Not(testing::Contains(tool)));
  truth["reflector_joint_x"] = 0.005;
  EXPECT_THAT(
      freed(tracked_arm(truth, 6).search()),
      testing::IsSupersetOf({std::string("elbow_joint"), std::string("wrist_1_joint"), tool}));
}

TEST(Mounts, ATrackerOnItsMountIsFoundWhole) {
  const RobotSearch search =
      tracked_arm({{"tracker_joint_y", 0.005}, {"tracker_joint_c", 2.0 * kDegree}}, 7).search();
  EXPECT_TRUE(is_named(search, "frame of tracker_joint")) << search_text(search);
}

TEST(Mounts, AMountThatAnUnknownPoseAbsorbsIsSaidToBeInseparable) {
  const RobotSearch search = tracked_arm({{"tracker_joint_y", 0.005}}, 9, false).search();
  EXPECT_THAT(freed(search), IsEmpty());
  EXPECT_THAT(search_text(search),
              testing::ContainsRegex("inseparable from the pose of tracker_frame, which is free "
                                     "and absorbs it: .*frame of tracker_joint"));
}

TEST(Mounts, ACameraInTheHandIsFoundThatTheConfigurationHolds) {
  const Errors truth = {{"camera_color_joint_x", 0.005}, {"camera_color_joint_b", 2.0 * kDegree}};
  const Recording recording = seen_board(4, "camera_color_joint", truth, 11);
  const RobotSearch search = recording.search();
  EXPECT_TRUE(is_named(search, "frame of camera_color_joint")) << search_text(search);
  EXPECT_LE(freed(search).size(), 2U) << search_text(search);
  const CalibrationResult result =
      calibrate(assembled(search.config, recording.robot, recording.samples));
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.table["camera_color_joint_b"].initial, 0.0) << "the table shows the change";
  EXPECT_NEAR(result.table["camera_color_joint_b"].value, 2.0 * kDegree, 0.1 * kDegree);
}

TEST(Mounts, TheChangeOfACameraThatIsFreeIsPrinted) {
  const Errors truth = {{"camera_color_joint_x", 0.005}, {"camera_color_joint_b", 2.0 * kDegree}};
  const RobotSearch search = seen_board(4, "", truth, 13).search();
  EXPECT_THAT(freed(search), IsEmpty());
  EXPECT_THAT(search_text(search),
              testing::ContainsRegex("the frame of camera_color_joint is free from the beginning "
                                     "and changes by (4.9|5)[0-9.]* mm, (1.9|2)[0-9.]* deg\n"));
}

TEST(Mounts, ABoardTwoDegreesOffInTheHandIsFound) {
  for (const char* axis : {"a", "b", "c"}) {
    const Errors truth = {{std::string("arm_chessboard_joint_") + axis, 2.0 * kDegree}};
    const RobotSearch search = seen_board(3, "checkerboard", truth, 17).search();
    EXPECT_TRUE(is_named(search, "frame of arm_chessboard_joint")) << axis << "\n"
                                                                   << search_text(search);
  }
}

TEST(Mounts, ACameraInTheHeadTwoDegreesOffIsFound) {
  for (const char* axis : {"a", "b", "c"}) {
    const Errors truth = {{std::string("head_camera_rgb_joint_") + axis, 2.0 * kDegree}};
    const RobotSearch search = seen_board(5, "head_camera_rgb_joint", truth, 19).search();
    EXPECT_TRUE(is_named(search, "frame of head_camera_rgb_joint")) << axis << "\n"
                                                                    << search_text(search);
  }
}

TEST(Mounts, NothingIsFreedWithoutAnError) {
  const auto seeds = static_cast<unsigned>(test::repetitions_of_study(40, 4));
  std::vector<std::string> all;
  int robots = 0;
  const auto add = [&](const Recording& recording) {
    const std::vector<std::string> names = freed(recording.search());
    all.insert(all.end(), names.begin(), names.end());
    ++robots;
  };
  for (unsigned seed = 100; seed < 100 + seeds; ++seed) {
    add(tracked_arm({}, seed));
    add(tracked_arm({}, seed, false));
    add(seen_board(3, "checkerboard", {}, seed));
    add(seen_board(4, "camera_color_joint", {}, seed));
    add(seen_board(5, "head_camera_rgb_joint", {}, seed));
  }
  const auto is_mount = [](const std::string& name) { return name.starts_with("frame of "); };
  EXPECT_EQ(std::count_if(all.begin(), all.end(), is_mount), 0);
  EXPECT_LE(std::ssize(all), 0.1 * robots) << "of some 130 candidates each";
}

}  // namespace
}  // namespace kinecal
