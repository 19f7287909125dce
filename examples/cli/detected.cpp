// What kinecal detect says of the samples that it found.
// SPDX-License-Identifier: Apache-2.0
#include "detected.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "kinecal/config/cameras/next_photographs.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// Joints that slide, if the robot is known.
std::set<std::string> sliding_joints(const std::optional<Robot>& robot) {
  std::set<std::string> sliding;
  if (!robot) return sliding;
  for (const Joint& joint : robot->joints()) {
    if (joint.type == JointType::prismatic) sliding.insert(joint.name);
  }
  return sliding;
}

/// "camera_lag, board_lag": parameters of the sensors in samples, cameras first.
std::string lags_of(const std::vector<Sample>& samples) {
  std::set<std::pair<bool, std::string>> sensors;
  for (const Sample& sample : samples) {
    for (const Observation& observation : sample.observations) {
      sensors.emplace(!observation.camera, observation.sensor);
    }
  }
  std::string text;
  for (const auto& [is_other, name] : sensors) text += (text.empty() ? "" : ", ") + name + "_lag";
  return text;
}

/// Warns if cameras share no photographs: nothing says where they stand then.
void warn_of_unshared(const std::vector<std::string>& cameras, const std::vector<Sample>& samples) {
  for (const std::string& camera : cameras) {
    const bool shares = std::any_of(samples.begin(), samples.end(), [&](const Sample& sample) {
      const bool sees = sample.observation(camera) != nullptr;
      return sees && std::count_if(sample.observations.begin(), sample.observations.end(),
                                   [](const Observation& of) { return of.camera.has_value(); }) > 1;
    });
    if (shares) continue;
    say(stderr,
        "warning: '{}' and another camera saw the board in no photographs of one name: where it "
        "stands cannot be calibrated; photographs taken at once have the same name in each "
        "folder\n",
        camera);
  }
}

}  // namespace

std::string count_of_targets(const std::vector<Sample>& samples) {
  std::map<std::string, std::size_t> counts;
  for (const Sample& sample : samples) {
    std::set<std::string> seen;
    for (const Observation& observation : sample.observations) {
      if (observation.camera) continue;  // in the frame of the camera
      for (const Feature& feature : observation.features) seen.insert(feature.frame);
    }
    for (const std::string& frame : seen) ++counts[frame];
  }
  if (counts.size() < 2) return {};
  std::string text;
  for (const auto& [frame, count] : counts) {
    text += fmt::format("{}'{}' in {}", text.empty() ? "; " : ", ", frame, count);
  }
  return text;
}

void print_speed(const std::vector<Sample>& samples, const std::optional<Robot>& robot) {
  const std::set<std::string> sliding = sliding_joints(robot);
  std::vector<double> speeds;
  for (const Sample& sample : samples) {
    if (const auto speed = fastest_joint(sample, sliding)) speeds.push_back(*speed);
  }
  if (speeds.empty()) return;
  std::sort(speeds.begin(), speeds.end());
  const double median = speeds[speeds.size() / 2];
  constexpr double kStands = 0.01;  // rad/s: a lag of 10 ms is 0.1 mrad
  if (median < kStands) {
    say("the robot stood in most views ({:.2g} rad/s in the median one): they say little about a "
        "lag between joints and camera; record it while it moves at 0.1 to 0.3 rad/s\n",
        median);
    return;
  }
  say("the robot moved at {:.2f} rad/s in the median view, at most at {:.2f} rad/s; a lag of 1 ms "
      "between joints and camera is {:.2g} mrad of the joints there: free that of what moves, {} "
      "(kinecal identify does)\n",
      median, speeds.back(), median, lags_of(samples));
}

void print_lacks(const std::vector<Sample>& samples, const std::vector<std::string>& rig) {
  warn_of_unshared(rig, samples);
  for (const std::string& advice : next_photographs(samples)) say("{}\n", advice);
}

}  // namespace kinecal::cli
