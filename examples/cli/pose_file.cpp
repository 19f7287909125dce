// SPDX-License-Identifier: Apache-2.0
#include "pose_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <utility>

#include "input.hpp"
#include "kinecal/files/recordings/pose_messages.hpp"
#include "kinecal/files/recordings/write_recording.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "output_file.hpp"

namespace kinecal::cli {
namespace {

/// Names of the joints of all chains.
std::set<std::string> moved_joints(const CaptureConfig& config) {
  std::set<std::string> moved;
  for (const CaptureChain& chain : config.chains) {
    moved.insert(chain.joints.begin(), chain.joints.end());
  }
  return moved;
}

/// Names of the joints of a robot that can move.
std::vector<std::string> joints_of(const Robot& robot) {
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints()) {
    if (joint.type != JointType::fixed) names.push_back(joint.name);
  }
  return names;
}

/// What is wrong with a pose.
struct PoseFault {
  std::string what;     ///< the same for poses with the same fault
  std::string details;  ///< of this pose
  bool is_error = true;
};

/// Adds that a position is beyond the limits of its joint.
void check_limits(const Robot& robot, const std::string& joint, double position,
                  std::vector<PoseFault>& faults) {
  const auto& limits = robot.joint(joint).limits;
  if (!limits || !(limits->lower < limits->upper)) return;
  const double beyond = std::max(limits->lower - position, position - limits->upper);
  if (beyond <= kSamePosition) return;
  // Where a person has put a robot, it may read a few degrees more, and its controllers decide.
  constexpr double kReadable = 0.1;
  const bool is_error = beyond > kReadable;
  faults.push_back(
      {fmt::format("joint '{}' is {}beyond its limits, {:.4g} to {:.4g}", joint,
                   is_error ? "" : "a little ", limits->lower, limits->upper),
       fmt::format(": at {:.4g}{}", position, is_error ? "" : "; the robot may skip the pose"),
       is_error});
}

std::vector<PoseFault> faults_of(const CapturePose& pose, const CaptureConfig& config,
                                 const Robot& robot) {
  std::vector<PoseFault> faults;
  const std::set<std::string> moved = moved_joints(config);
  for (std::size_t i = 0; i < pose.joint_names.size(); ++i) {
    const std::string& joint = pose.joint_names[i];
    const bool is_left_out = !moved.empty() && !moved.contains(joint);
    if (robot.has_joint(joint)) {
      if (!is_left_out) check_limits(robot, joint, pose.positions[i], faults);
    } else if (!is_left_out || nearest_name(joint, moved)) {
      faults.push_back(
          {"the robot has no joint '" + joint + "'", did_you_mean(joint, joints_of(robot))});
    }
  }
  std::vector<std::string> finders;
  for (const CaptureFinder& finder : config.finders) finders.push_back(finder.name);
  for (const std::string& name : pose.features) {
    if (std::find(finders.begin(), finders.end(), name) != finders.end()) continue;
    faults.push_back(
        {"the configuration has no finder '" + name + "'", did_you_mean(name, finders)});
  }
  return faults;
}

}  // namespace

bool is_end(const std::string& line) {
  const auto is = [&](std::string_view word) { return edit_distance(line, word) == 0; };
  return line == "q" || is("done") || is("exit");
}

double within_limits(const Robot& robot, const std::string& joint, double position) {
  if (!robot.has_joint(joint)) return position;
  const auto& limits = robot.joint(joint).limits;
  if (!limits || !(limits->lower < limits->upper)) return position;
  const double nearest = std::clamp(position, limits->lower, limits->upper);
  return std::abs(nearest - position) <= kSamePosition ? nearest : position;
}

void check_chains(const std::string& file, const CaptureConfig& config, const Robot& robot) {
  Diagnostics diagnostics;
  for (const CaptureChain& chain : config.chains) {
    for (const std::string& joint : chain.joints) {
      if (robot.has_joint(joint)) continue;
      diagnostics.error({file, 0}, "chain '" + chain.name + "': the robot has no joint '" + joint +
                                       "'" + did_you_mean(joint, joints_of(robot)));
    }
  }
  print_or_throw(diagnostics);
}

void check_poses(const std::vector<CapturePose>& poses, const CaptureConfig& config,
                 const Robot& robot) {
  std::vector<std::pair<PoseFault, std::string>> first;  // and where it is
  std::map<std::string, std::size_t> count;
  for (const CapturePose& pose : poses) {
    for (const PoseFault& fault : faults_of(pose, config, robot)) {
      if (++count[fault.what] == 1) first.emplace_back(fault, pose.source);
    }
  }
  Diagnostics diagnostics;
  for (const auto& [fault, source] : first) {
    const std::size_t others = count[fault.what] - 1;
    (fault.is_error ? diagnostics.errors : diagnostics.warnings)
        .push_back(source + ": " + fault.what + fault.details +
                   (others > 0 ? " (and " + counted(others, "other pose") + ")" : std::string()));
  }
  print_or_throw(diagnostics);
}

std::vector<CapturePose> read_pose_file(const std::string& path) {
  std::error_code unknown;
  if (std::filesystem::file_size(path, unknown) == 0) throw InputError(path + ": is empty");
  const bool is_yaml = path.ends_with(".yaml") || path.ends_with(".yml");
  if (is_yaml && std::filesystem::is_regular_file(path, unknown) && !is_poses_yaml(path)) {
    throw InputError(path + ": is not a list of poses, {joints: [], positions: []}");
  }
  Diagnostics diagnostics;
  std::vector<CapturePose> poses =
      is_poses_yaml(path) ? read_poses_yaml(path, diagnostics) : read_bag_poses(path, diagnostics);
  print_or_throw(diagnostics);
  if (poses.empty()) throw InputError(path + ": has no poses");
  return poses;
}

void write_pose_file(const std::string& path, const std::vector<CapturePose>& poses) {
  const std::optional<Encoding> encoding = output_encoding(path);
  if (poses.empty()) {
    std::filesystem::remove(path);
  } else if (encoding) {
    const OutputFolder folder(folder_of(path));  // creates it if it is missing
    BagOutput bag(path, *encoding);
    write_poses(bag, poses);
    bag.finish(existing_at(path));
  } else {
    std::ostringstream text;
    write_poses_yaml(text, poses);
    write_output(path, text.str());
  }
}

}  // namespace kinecal::cli
