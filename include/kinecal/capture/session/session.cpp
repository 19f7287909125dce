// Definitions of session.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/session/session.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

NextPose poses_of(std::vector<CapturePose> poses) {
  return [left = std::move(poses), i = std::size_t{0}]() mutable -> std::optional<CapturePose> {
    if (i == left.size()) return std::nullopt;
    return left[i++];
  };
}

std::vector<CapturePose> poses_left(std::span<const CapturePose> poses,
                                    std::span<const Sample> samples,
                                    const SettleOptions& settling) {
  std::vector<bool> taken(poses.size(), false);
  const auto matches = [&](const CapturePose& pose, const Sample& sample) {
    if (pose.joint_names.empty()) return false;
    for (std::size_t i = 0; i < pose.joint_names.size() && i < pose.positions.size(); ++i) {
      const std::string& name = pose.joint_names[i];
      const std::optional<double> position = sample.position(name);
      if (!position || !(joint_distance(name, *position, pose.positions[i], settling.continuous) <=
                         settling.arrival)) {
        return false;
      }
    }
    return true;
  };
  const Sample* last = nullptr;
  for (const Sample& sample : samples) {
    // A pose may have given several samples, of several finders: they have the same positions.
    if (last != nullptr && last->joint_positions == sample.joint_positions) continue;
    last = &sample;
    for (std::size_t p = 0; p < poses.size(); ++p) {
      if (taken[p] || !matches(poses[p], sample)) continue;
      taken[p] = true;
      break;
    }
  }
  std::vector<CapturePose> left;
  for (std::size_t p = 0; p < poses.size(); ++p) {
    if (!taken[p]) left.push_back(poses[p]);
  }
  return left;
}

namespace detail {

std::vector<const SessionFinder*> finders_of(const CapturePose& pose,
                                             std::span<const SessionFinder> finders) {
  std::vector<const SessionFinder*> wanted;
  for (const SessionFinder& finder : finders) {
    if (pose.features.empty()) wanted.push_back(&finder);
  }
  for (const std::string& name : pose.features) {
    const auto found = std::find_if(finders.begin(), finders.end(),
                                    [&](const SessionFinder& f) { return f.name == name; });
    if (found == finders.end()) {
      std::vector<std::string> names;
      for (const SessionFinder& finder : finders) names.push_back(finder.name);
      throw std::invalid_argument("a pose asks for finder '" + name + "', which does not exist" +
                                  did_you_mean(name, names));
    }
    wanted.push_back(&*found);
  }
  return wanted;
}

std::vector<Sample> samples_of(const MeasuredJoints& joints,
                               std::span<const FinderOutcome> outcomes) {
  std::vector<Sample> samples;
  for (const FinderOutcome& outcome : outcomes) {
    if (!outcome.found) continue;
    const std::vector<Observation>& observations = outcome.found.observations;
    const auto is_free = [&](const Sample& sample) {
      return std::none_of(observations.begin(), observations.end(), [&](const Observation& o) {
        return sample.observation(o.sensor) != nullptr;
      });
    };
    auto to = std::find_if(samples.begin(), samples.end(), is_free);
    if (to == samples.end()) {
      Sample sample;
      sample.joint_names = joints.names;
      sample.joint_positions = joints.positions;
      sample.joint_velocities = joints.velocities;
      sample.poses = joints.poses;
      sample.stamp = joints.stamp;
      to = samples.insert(samples.end(), std::move(sample));
    }
    to->observations.insert(to->observations.end(), observations.begin(), observations.end());
  }
  return samples;
}

std::string moved_meanwhile(const MeasuredJoints& before, const MeasuredJoints& after,
                            const SessionOptions& options) {
  for (std::size_t i = 0; i < before.names.size(); ++i) {
    const std::optional<double> now = after.position(before.names[i]);
    if (now && joint_distance(before.names[i], *now, before.positions[i],
                              options.settling.continuous) <= options.moved) {
      continue;
    }
    std::ostringstream text;
    text << "joint '" << before.names[i] << "' moved while finders looked";
    if (now) text << ": from " << before.positions[i] << " to " << *now;
    return text.str();
  }
  return {};
}

}  // namespace detail
}  // namespace kinecal
