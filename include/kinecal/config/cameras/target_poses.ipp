// Where targets are in the samples with which cameras begin.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kinecal/config/cameras/camera_places.ipp"
#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

[[nodiscard]] inline std::set<std::string> joints_of(const std::vector<SeenTarget>& seen) {
  std::set<std::string> joints;
  for (const SeenTarget& of : seen) joints.insert(of.pair.joint);
  return joints;
}

/// The poses of targets in the samples, each by the camera that saw most of it.
inline void set_poses(const Config& config, const Robot& robot, const std::vector<SeenTarget>& seen,
                      const std::map<std::string, Pose<double>>& cameras,
                      std::vector<Sample>& samples) {
  for (std::size_t s = 0; s < samples.size(); ++s) {
    Sample& sample = samples[s];
    std::map<std::string, std::size_t> corners;  // that gave the pose of a joint
    for (const std::string& joint : joints_of(seen)) {
      if (sample.poses.contains(joint)) corners[joint] = std::numeric_limits<std::size_t>::max();
    }
    for (const SeenTarget& of : seen) {
      const auto pose = of.poses.find(s);
      if (pose == of.poses.end()) continue;
      const std::size_t count = target_view(of.pair, sample).pixels.size();
      if (count <= corners[of.pair.joint]) continue;
      const auto placed = cameras.find(of.pair.camera->name);
      const std::optional<Pose<double>> camera =
          placed != cameras.end() ? placed->second
                                  : pose_of_link(config, robot, of.pair.camera->frame, sample);
      const Joint& joint = robot.joint(of.pair.joint);
      const auto parent = pose_of_link(config, robot, joint.parent, sample);
      if (!camera || !parent) continue;
      sample.poses[of.pair.joint] = (*parent * joint.origin).inverse() * *camera * pose->second;
      corners[of.pair.joint] = count;
    }
  }
}

/// Takes targets out of the samples in which no camera shows where they were.
inline void drop_unplaced(const std::vector<TargetPair>& pairs, std::vector<Sample>& samples,
                          Diagnostics& diagnostics) {
  Occurrences dropped;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    Sample& sample = samples[s];
    std::set<std::string> targets;
    bool was_seen = false;
    for (const TargetPair& pair : pairs) {
      if (sample.poses.contains(pair.joint)) continue;
      was_seen = was_seen || !target_view(pair, sample).pixels.empty();
      targets.insert(pair.target->name);
    }
    std::erase_if(sample.observations,
                  [&](const Observation& seen) { return targets.contains(seen.sensor); });
    if (was_seen) dropped.add(s);
  }
  if (dropped.count == 0) return;
  diagnostics.note(
      place_of(samples, dropped.first),
      fmt::format("no camera shows where the target was, by four corners or more that are "
                  "not nearly on a line: left out{}",
                  dropped.others()));
}

}  // namespace kinecal::detail
