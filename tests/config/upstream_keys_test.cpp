// Every key that robot_calibration reads in ROS 2, its branch ros2 and forks in use: read here too, or
// ignored for a reason.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "kinecal/config/capture/capture_config.hpp"
#include "kinecal/config/read_config.hpp"
#include "support/temporary_folder.hpp"

namespace kinecal {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

struct UpstreamKey {
  const char *where, *key;
  const char* ignored_because = "";  ///< empty: it is read
};

constexpr const char *kNode = "of every node of ROS 2",
                     *kDebug = "adds images or clouds to samples",
                     *kDriver = "a camera_info holds the driver's z_offset_mm and z_scaling",
                     *kRecording = "says where samples are recorded, not what they mean",
                     *kOwnMotion = "motions here are slow enough by the joints' limits";

constexpr UpstreamKey kUpstreamKeys[] = {
    // nodes/calibrate.cpp, optimization/params.cpp
    {"calibration", "base_link"},
    {"calibration", "verbose", "what is printed is an option of the program"},
    {"calibration", "use_sim_time", kNode},
    {"calibration", "start_type_description_service", kNode},
    {"calibration", "duration", "of the capture in the same file"},
    {"calibration", "settling_timeout", "of the capture in the same file"},
    {"step", "max_num_iterations"},
    {"step", "free_params"},
    {"step", "free_frames"},
    {"step", "free_frames_initial_values"},
    {"step", "models"},
    {"step", "error_blocks"},
    {"free frame", "x"},
    {"free frame", "y"},
    {"free frame", "z"},
    {"free frame", "roll"},
    {"free frame", "pitch"},
    {"free frame", "yaw"},
    {"initial value", "x"},
    {"initial value", "y"},
    {"initial value", "z"},
    {"initial value", "roll"},
    {"initial value", "pitch"},
    {"initial value", "yaw"},
    {"model", "frame"},
    {"model", "param_name"},
    {"model", "topic", kRecording},
    {"model", "camera_info_topic", kRecording},
    {"block chain3d_to_chain3d", "model_a"},
    {"block chain3d_to_chain3d", "model_b"},
    {"block chain3d_to_camera2d", "model_2d"},
    {"block chain3d_to_camera2d", "model_3d"},
    {"block chain3d_to_camera2d", "scale"},
    {"block chain3d_to_plane", "model"},
    {"block chain3d_to_plane", "a"},
    {"block chain3d_to_plane", "b"},
    {"block chain3d_to_plane", "c"},
    {"block chain3d_to_plane", "d"},
    {"block chain3d_to_plane", "scale"},
    {"block plane_to_plane", "model_a"},
    {"block plane_to_plane", "model_b"},
    {"block plane_to_plane", "normal_scale"},
    {"block plane_to_plane", "offset_scale"},
    {"block outrageous", "param"},
    {"block outrageous", "joint_scale"},
    {"block outrageous", "position_scale"},
    {"block outrageous", "rotation_scale"},
    {"block camera2d_to_camera2d", "model_a"},
    {"block camera2d_to_camera2d", "model_b"},
    {"block camera2d_to_camera2d", "scale"},
    {"block camera2d_to_camera2d", "points_x", "lines of sight need no board"},
    {"block camera2d_to_camera2d", "points_y", "lines of sight need no board"},
    {"block camera2d_to_camera2d", "size", "lines of sight need no board"},
    // util/chain_manager.cpp, util/capture_manager.cpp
    {"capture", "chains"},
    {"capture", "duration"},
    {"capture", "velocity_factor", kOwnMotion},
    {"capture", "settling_timeout", "the joints are seen to rest"},
    {"capture", "use_sim_time", kNode},
    {"capture", "qos_overrides", kNode},
    {"capture", "base_link", "of the calibration in the same file"},
    {"chain", "topic"},
    {"chain", "joints"},
    {"chain", "planning_group", "there is no MoveIt here; motions are from pose to pose"},
    // util/depth_camera_info.hpp
    {"LedFinder", "camera_info_topic"},
    {"LedFinder", "camera_driver", kDriver},
    {"LedFinder", "canera_driver", kDriver},
    // finders/led_finder.cpp
    {"LedFinder", "action"},
    {"LedFinder", "topic"},
    {"LedFinder", "max_error"},
    {"LedFinder", "max_inconsistency"},
    {"LedFinder", "threshold"},
    {"LedFinder", "max_iterations"},
    {"LedFinder", "debug", kDebug},
    {"LedFinder", "camera_sensor_name"},
    {"LedFinder", "chain_sensor_name"},
    {"LedFinder", "gripper_led_frame"},
    {"LedFinder", "leds"},
    {"LedFinder", "poses"},
    {"LED", "code"},
    {"LED", "x"},
    {"LED", "y"},
    {"LED", "z"},
    {"LED", "topic", kDebug},
    // finders/checkerboard_finder.cpp
    {"CheckerboardFinder", "topic"},
    {"CheckerboardFinder", "points_x"},
    {"CheckerboardFinder", "points_y"},
    {"CheckerboardFinder", "size"},
    {"CheckerboardFinder", "debug", kDebug},
    {"CheckerboardFinder", "frame_id"},
    {"CheckerboardFinder", "camera_sensor_name"},
    {"CheckerboardFinder", "chain_sensor_name"},
    {"CheckerboardFinder", "chain_sensor_name_id"},
    {"CheckerboardFinder", "camera_info_topic"},
    {"CheckerboardFinder", "canera_driver", kDriver},
    {"CheckerboardFinder", "checkerboard_type"},
    {"CheckerboardFinder", "max_trials_count", "each new image is tried until the time is over"},
    // finders/plane_finder.cpp
    {"PlaneFinder", "topic"},
    {"PlaneFinder", "camera_sensor_name"},
    {"PlaneFinder", "points_max"},
    {"PlaneFinder", "initial_sample_distance", "points are spread evenly"},
    {"PlaneFinder", "tolerance"},
    {"PlaneFinder", "transform_frame"},
    {"PlaneFinder", "min_x"},
    {"PlaneFinder", "max_x"},
    {"PlaneFinder", "min_y"},
    {"PlaneFinder", "max_y"},
    {"PlaneFinder", "min_z"},
    {"PlaneFinder", "max_z"},
    {"PlaneFinder", "ransac_iterations"},
    {"PlaneFinder", "ransac_points", "three points define a plane"},
    {"PlaneFinder", "normal_a"},
    {"PlaneFinder", "normal_b"},
    {"PlaneFinder", "normal_c"},
    {"PlaneFinder", "normal_angle"},
    {"PlaneFinder", "debug", kDebug},
    {"PlaneFinder", "camera_info_topic"},
    {"PlaneFinder", "canera_driver", kDriver},
    // finders/robot_finder.cpp
    {"RobotFinder", "camera_sensor_name"},
    {"RobotFinder", "robot_sensor_name"},
    {"RobotFinder", "min_robot_x"},
    {"RobotFinder", "max_robot_x"},
    {"RobotFinder", "min_robot_y"},
    {"RobotFinder", "max_robot_y"},
    {"RobotFinder", "min_robot_z"},
    {"RobotFinder", "max_robot_z"},
    // finders/scan_finder.cpp
    {"ScanFinder", "topic"},
    {"ScanFinder", "sensor_name"},
    {"ScanFinder", "transform_frame"},
    {"ScanFinder", "min_x"},
    {"ScanFinder", "max_x"},
    {"ScanFinder", "min_y"},
    {"ScanFinder", "max_y"},
    {"ScanFinder", "z_repeats"},
    {"ScanFinder", "z_offset"},
    {"ScanFinder", "debug", kDebug},
};

/// What is said of a file in which a key has a map as its value, which no key takes.
Diagnostics said_of(const UpstreamKey& key) {
  const std::string where = key.where, entry = std::string(key.key) + ": {deep: 1}";
  const bool is_capture =
      where.ends_with("Finder") || where == "LED" || where == "chain" || where == "capture";
  std::string text = "robot_calibration:\n  ros__parameters:\n    ";
  if (where == "capture") {
    text += entry + "\n    features: []\n";
  } else if (where == "chain") {
    text += "chains: [c]\n    c: {" + entry + "}\n    features: []\n";
  } else if (where == "LED") {
    text += "features: [f]\n    f: {type: LedFinder, leds: [a], a: {" + entry + "}}\n";
  } else if (is_capture) {
    text += "features: [f]\n    f: {type: 'robot_calibration::" + where + "', " + entry + "}\n";
  } else if (where == "calibration") {
    text += "calibration_steps: [s]\n    s: {free_params: [j]}\n    " + entry + "\n";
  } else {
    text += "calibration_steps: [s]\n    s: {";
    if (where == "step") text += entry;
    if (where == "model") text += "models: [m], m: {type: camera3d, " + entry + "}";
    if (where == "free frame") text += "free_frames: [f], f: {" + entry + "}";
    if (where == "initial value") {
      text += "free_frames_initial_values: [f], f_initial_values: {" + entry + "}";
    }
    if (where.starts_with("block ")) {
      text += "error_blocks: [b], b: {type: " + where.substr(6) + ", " + entry + "}";
    }
    text += "}\n";
  }
  const test::TemporaryFolder folder;
  const std::string path = (folder.path() / "file.yaml").string();
  std::ofstream(path) << text;
  Diagnostics said;
  if (is_capture) {
    (void)read_capture_config(path, said);
  } else {
    (void)read_config(path, said);
  }
  return said;
}

TEST(UpstreamKeys, AreReadOrIgnoredForAReason) {
  for (const UpstreamKey& key : kUpstreamKeys) {
    SCOPED_TRACE(std::string(key.where) + ": " + key.key);
    const Diagnostics said = said_of(key);
    const std::string name = key.key;
    if (*key.ignored_because == '\0') {
      EXPECT_THAT(said.errors, Contains(HasSubstr(name + " is a map, not ")));
    } else {
      EXPECT_THAT(said.errors, Not(Contains(HasSubstr(name + " is a map"))));
    }
    EXPECT_THAT(said.errors, Not(Contains(HasSubstr("unknown key '" + name + "'"))));
    EXPECT_THAT(said.warnings, Not(Contains(HasSubstr("'" + name + "'"))));
  }
}

TEST(UpstreamKeys, WhatIsNotSupportedIsNamed) {
  Diagnostics said;
  (void)parse_config(
      "models: [{name: m, type: chain, frame: f}]\nfree_params: [j]\n"
      "error_blocks: [{name: b, type: chain3d_to_plane_normal, model: m}]\n",
      "c.yaml", said);
  EXPECT_THAT(said.errors, Contains(HasSubstr("'chain3d_to_plane_normal'")));
  const UpstreamKey board = {"CheckerboardFinder", "checkerboard_type"};
  EXPECT_THAT(said_of(board).errors, Contains(HasSubstr("checkerboard_type")));
}

}  // namespace
}  // namespace kinecal
