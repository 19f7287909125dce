// SPDX-License-Identifier: Apache-2.0
#include "pose_file.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>

#include "input.hpp"
#include "kinecal/io/recordings/pose_messages.hpp"
#include "kinecal/io/recordings/write_recording.hpp"
#include "kinecal/io/results/file_set.hpp"
#include "kinecal/kinematics/nearest_name.hpp"
#include "output_file.hpp"

namespace kinecal::cli {
namespace {

/// Sentences, a few of them, each with how often it was said.
class Remarks {
 public:
  /// @param pose  by number, from 1
  void add(const std::string& what, std::size_t pose) {
    if (const auto known = index_.find(what); known != index_.end()) {
      ++all_[known->second].more;
      return;
    }
    index_.emplace(what, all_.size());
    all_.push_back({what, pose, 0});
  }
  [[nodiscard]] bool empty() const { return all_.empty(); }
  /// "file: pose 3: joint 'elbw' ..., and 4 more poses"
  [[nodiscard]] std::vector<std::string> sentences(const std::string& path) const {
    std::vector<std::string> lines;
    for (const Remark& remark : all_) {
      std::string line = fmt::format("{}: pose {}: {}", path, remark.pose, remark.what);
      if (remark.more > 0) {
        line += fmt::format("; and in {} more pose{}", remark.more, remark.more == 1 ? "" : "s");
      }
      lines.push_back(std::move(line));
    }
    return lines;
  }

 private:
  struct Remark {
    std::string what;
    std::size_t pose, more;
  };
  std::vector<Remark> all_;
  std::map<std::string, std::size_t> index_;
};

/// "elbow is beyond its limits of -120 to 120 deg"; empty if it is not.
std::string beyond_limits(const Joint& joint, double position) {
  constexpr double kNear = 0.005;  // encoders read a little beyond limits
  if (!joint.limits || !(joint.limits->lower < joint.limits->upper)) return "";
  if (position > joint.limits->lower - kNear && position < joint.limits->upper + kNear) return "";
  const bool is_angle = turns(joint.type);
  const double factor = is_angle ? 180.0 / std::numbers::pi : 1e3;
  return fmt::format("joint '{}' is beyond its limits of {:.4g} to {:.4g} {}", joint.name,
                     factor * joint.limits->lower, factor * joint.limits->upper,
                     is_angle ? "deg" : "mm");
}

/// Throws the last error; prints those before it.
void throw_all(const std::vector<std::string>& errors) {
  Diagnostics diagnostics;
  diagnostics.errors = errors;
  print_or_throw(diagnostics);
}

}  // namespace

void check_poses(const std::string& path, const std::vector<CapturePose>& poses,
                 const PoseDemands& demands) {
  Remarks errors, limits;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    for (std::size_t i = 0; i < poses[p].joint_names.size(); ++i) {
      const std::string& joint = poses[p].joint_names[i];
      if (!demands.robot.has_joint(joint)) {
        errors.add(fmt::format("the robot has no joint '{}'{}", joint,
                               did_you_mean(joint, demands.robot.joint_names())),
                   p + 1);
        continue;
      }
      const std::string why = beyond_limits(demands.robot.joint(joint), poses[p].positions[i]);
      if (!why.empty()) limits.add(why, p + 1);
    }
    for (const std::string& finder : poses[p].features) {
      if (std::find(demands.finders.begin(), demands.finders.end(), finder) !=
          demands.finders.end()) {
        continue;
      }
      errors.add(fmt::format("asks for finder '{}', which the configuration does not have{}",
                             finder, did_you_mean(finder, demands.finders)),
                 p + 1);
    }
  }
  Diagnostics warnings;
  warnings.warnings = limits.sentences(path);
  print(warnings);
  throw_all(errors.sentences(path));
}

void check_chains(const std::string& path, const CaptureConfig& config, const Robot& robot) {
  std::vector<std::string> errors;
  for (const CaptureChain& chain : config.chains) {
    for (const std::string& joint : chain.joints) {
      if (robot.has_joint(joint)) continue;
      errors.push_back(fmt::format("{}: chain '{}': the robot has no joint '{}'{}", path,
                                   chain.name, joint, did_you_mean(joint, robot.joint_names())));
    }
  }
  throw_all(errors);
}

std::vector<std::string> finder_names(const CaptureConfig& config) {
  std::vector<std::string> names;
  for (const CaptureFinder& finder : config.finders) names.push_back(finder.name);
  return names;
}

std::vector<CapturePose> read_pose_file(const std::string& path) {
  std::error_code unknown;
  if (std::filesystem::file_size(path, unknown) == 0) throw InputError(path + ": is empty");
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
    bag.finish();
  } else {
    std::ostringstream text;
    write_poses_yaml(text, poses);
    write_file(path, text.str());
  }
}

}  // namespace kinecal::cli
