// kinecal capture_poses: a person moves the robot, each Enter records where it stands.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <set>
#include <sstream>
#include <utility>

#include "commands.hpp"
#include "input.hpp"
#include "interruption.hpp"
#include "kinecal/capture/session/session_faults.hpp"
#include "kinecal/capture/session/settling.hpp"
#include "kinecal/files/recordings/write_recording.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "output_file.hpp"
#include "pose_file.hpp"
#include "robot_link.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// "led_finder, board".
std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// All joints of a robot that are measured, as one chain.
CaptureChain all_joints(const Robot& robot) {
  CaptureChain chain{"all joints", "", {}};
  for (const Joint& joint : robot.joints()) {
    if (moves(joint.type) && !joint.mimic) chain.joints.push_back(joint.name);
  }
  return chain;
}

std::vector<std::string> joint_names(const Robot& robot) {
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints()) names.push_back(joint.name);
  return names;
}

/// @throws InputError  if poses from before are of another robot
void check_before(const std::vector<CapturePose>& poses, const CaptureConfig& config,
                  const Robot& robot) {
  check_poses(poses, config, robot);
  for (const CapturePose& pose : poses) {
    for (const CaptureChain& chain : config.chains) {
      for (const std::string& joint : chain.joints) {
        const auto& names = pose.joint_names;
        if (std::find(names.begin(), names.end(), joint) != names.end()) continue;
        throw InputError(pose.source + ": has no joint '" + joint + "' of chain '" + chain.name +
                         "'; --resume goes on with the same robot" + did_you_mean(joint, names));
      }
    }
  }
}

/// Whether two poses capture the same at the same positions.
/// @param continuous  joints that turn without end
bool is_same(const CapturePose& a, const CapturePose& b, const std::set<std::string>& continuous) {
  if (a.joint_names != b.joint_names || a.features != b.features) return false;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    const double away =
        joint_distance(a.joint_names[i], a.positions[i], b.positions[i], continuous);
    if (away > kSamePosition) return false;
  }
  return true;
}

/// Poses that a person shows, and the file that always has all of them.
class PoseRecorder {
 public:
  PoseRecorder(AnyArm arm, const CaptureConfig& config, const Robot& robot, std::string file,
               std::vector<CapturePose> poses)
      : arm_(std::move(arm)),
        config_(config),
        robot_(robot),
        file_(std::move(file)),
        poses_(std::move(poses)) {
    for (const CaptureFinder& finder : config_.finders) known_.push_back(finder.name);
  }

  [[nodiscard]] const std::vector<CapturePose>& poses() const { return poses_; }
  /// Names of all features.
  [[nodiscard]] const std::vector<std::string>& known() const { return known_; }

  /// Records where the robot stands.
  /// @throws PoseError  why not
  void record() {
    CapturePose pose = measured();
    if (!poses_.empty() && is_same(poses_.back(), pose, continuous_joints(robot_))) {
      throw PoseError("the robot has not moved since the last pose");
    }
    poses_.push_back(std::move(pose));
    write_pose_file(file_, poses_);
    say("pose {}: {}\n", poses_.size(), features());
  }

  /// Removes the last pose.
  void undo() {
    if (poses_.empty()) throw PoseError("there is no pose to remove");
    poses_.pop_back();
    write_pose_file(file_, poses_);
    say("pose {} is removed\n", poses_.size() + 1);
  }

  /// Takes names of features for the next poses: "led_finder board", or "all".
  void choose(const std::string& words) {
    std::vector<std::string> chosen;
    std::istringstream text(words);
    for (std::string name; text >> name;) {
      if (name == "all") continue;
      if (std::find(known_.begin(), known_.end(), name) == known_.end()) {
        throw PoseError("'" + name + "' is not a feature of the configuration" +
                        did_you_mean(name, known_));
      }
      chosen.push_back(name);
    }
    features_ = chosen;
    say("the next poses: {}\n", features());
  }

 private:
  [[nodiscard]] std::string features() const {
    return features_.empty() ? "all features" : listed(features_);
  }

  /// Where the robot stands: the joints of its chains, or all if there are no chains.
  [[nodiscard]] CapturePose measured() {
    SettleOptions settling;
    settling.time_limit = std::chrono::seconds(3);
    const MeasuredJoints joints = settle_joints(arm_, {}, now_, settling);
    now_ = joints.stamp;
    if (const std::string why = like_degrees(joints, robot_); !why.empty()) throw PoseError(why);
    CapturePose pose{{}, {}, features_};
    for (const CaptureChain& chain : config_.chains) {
      for (const std::string& joint : chain.joints) {
        const auto position = joints.position(joint);
        if (!position) {
          throw PoseError("joint '" + joint + "' of chain '" + chain.name + "' is not measured" +
                          did_you_mean(joint, joints.names));
        }
        pose.joint_names.push_back(joint);
        pose.positions.push_back(*position);
      }
    }
    if (config_.chains.empty()) pose = {joints.names, joints.positions, features_};
    check(pose);
    for (std::size_t i = 0; i < pose.positions.size(); ++i) {
      pose.positions[i] = within_limits(robot_, pose.joint_names[i], pose.positions[i]);
    }
    return pose;
  }

  /// @throws PoseError  if the URDF is not that of the robot
  void check(const CapturePose& pose) const {
    for (const std::string& joint : pose.joint_names) {
      if (robot_.has_joint(joint)) continue;
      throw PoseError("the URDF has no joint '" + joint + "', which the robot measures" +
                      did_you_mean(joint, joint_names(robot_)) +
                      "; name the joints that are wanted in chains of the configuration");
    }
  }

  AnyArm arm_;
  CaptureConfig config_;
  Robot robot_;
  std::string file_;
  std::vector<CapturePose> poses_;
  std::vector<std::string> known_, features_;
  Stamp now_ = Stamp::min();  ///< of the robot's clock
};

/// Asks until a person ends it.
void record_poses(PoseRecorder& recorder) {
  say("move the robot, then press Enter to record its pose; u removes the last pose, q ends\n");
  if (!recorder.known().empty()) {
    say("all poses capture all features; type the names of some for the next poses: {}, or all\n",
        listed(recorder.known()));
  }
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line);) {
    line.erase(0, line.find_first_not_of(" \t\r"));
    line.erase(line.find_last_not_of(" \t\r") + 1);
    if (is_end(line)) return;
    try {
      if (line.empty()) {
        recorder.record();
      } else if (line == "u") {
        recorder.undo();
      } else {
        recorder.choose(line);
      }
    } catch (const PoseError& error) {
      say("nothing is recorded: {}\n", error.what());
    }
    std::fflush(stdout);
  }
}

}  // namespace

int capture_poses(const CapturePosesOptions& options) {
  (void)output_encoding(options.output);
  check_output(options.output, {options.config, options.urdf}, options.force || options.resume);
  Diagnostics diagnostics;
  CaptureConfig config;
  if (!options.config.empty()) config = read_capture_config(options.config, diagnostics);
  print(diagnostics);
  if (!diagnostics.errors.empty()) return kBadInput;
  const Robot robot = parse_urdf(urdf_of(options.urdf, options.robot), urdf_name(options.urdf));
  if (options.config.empty()) config.chains = {all_joints(robot)};
  check_chains(options.config, config, robot);
  std::vector<CapturePose> before;
  if (options.resume && std::filesystem::exists(options.output)) {
    before = read_pose_file(options.output);
    check_before(before, config, robot);
    say("{}: {} from before\n", options.output, counted(before.size(), "pose"));
  }
  CaptureConfig joints_only = config;
  joints_only.finders.clear();
  const Interruption interruption;
  AnyRobot hardware =
      connect(options.robot, joints_only, robot, {}, MovedBy::person, {options.joints, ""});
  PoseRecorder recorder(hardware.arm, config, robot, options.output, std::move(before));
  std::string lost;
  try {
    record_poses(recorder);
  } catch (const ConnectionError& error) {
    lost = error.what();
  }
  const std::size_t count = recorder.poses().size();
  if (count > 0) say("{}: {}\n", options.output, counted(count, "pose"));
  std::fflush(stdout);
  if (Interruption::is_asked()) {
    say(stderr, "error: interrupted{}\n", count > 0 ? "; --resume goes on from here" : "");
    return kInterrupted;
  }
  if (!lost.empty()) {
    say(stderr, "error: {}{}\n", lost, count > 0 ? "; --resume goes on from here" : "");
  } else if (count == 0) {
    say(stderr, "error: no pose was recorded\n");
  }
  return lost.empty() && count > 0 ? kDone : kBadInput;
}

}  // namespace kinecal::cli
