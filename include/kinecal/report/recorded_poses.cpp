// Choosing poses.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/recorded_poses.hpp"

#include <algorithm>
#include <set>

namespace kinecal {

RecordedPoses recorded_poses(const Calibration& calibration, std::span<const Sample> samples) {
  std::set<std::string> joints, floating;
  for (const CalibrationStep& step : calibration.steps) {
    for (const MountedSensor& sensor : step.problem->sensors()) {
      for (const auto& chain : sensor.chains()) {
        for (const ChainJoint& joint : chain.chain().joints) {
          if (has_position(joint)) joints.insert(joint.drive.joint);
          if (!joint.floating.empty()) floating.insert(joint.floating);
        }
      }
    }
  }
  RecordedPoses poses{{joints.begin(), joints.end()}, {}, {floating.begin(), floating.end()}, {}};
  constexpr std::size_t kMost = 100;
  const std::size_t used = std::min(kMost, samples.size());
  for (std::size_t i = 0; i < used; ++i) {
    const Sample& sample = samples[i * samples.size() / used];
    std::vector<double> positions;
    for (const std::string& joint : poses.joints) {
      if (const auto position = sample.position(joint)) positions.push_back(*position);
    }
    std::vector<Pose<double>> measured;
    for (const std::string& joint : poses.floating) {
      const auto pose = sample.poses.find(joint);
      if (pose != sample.poses.end()) measured.push_back(pose->second);
    }
    if (positions.size() != joints.size() || measured.size() != floating.size()) continue;
    poses.positions.push_back(std::move(positions));
    if (!floating.empty()) poses.measured.push_back(std::move(measured));
  }
  return poses;
}

}  // namespace kinecal
