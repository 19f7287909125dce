// Choosing poses.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/recorded_poses.hpp"

#include <algorithm>
#include <set>

namespace kinecal {

RecordedPoses recorded_poses(const Calibration& calibration, std::span<const Sample> samples) {
  std::set<std::string> joints;
  for (const CalibrationStep& step : calibration.steps) {
    for (const MountedSensor& sensor : step.problem->sensors()) {
      for (const auto& chain : sensor.chains()) {
        for (const ChainJoint& joint : chain.chain().joints) {
          if (moves(joint.type)) joints.insert(joint.drive.joint);
        }
      }
    }
  }
  RecordedPoses poses{{joints.begin(), joints.end()}, {}};
  constexpr std::size_t kMost = 100;
  const std::size_t used = std::min(kMost, samples.size());
  for (std::size_t i = 0; i < used; ++i) {
    const Sample& sample = samples[i * samples.size() / used];
    std::vector<double> positions;
    for (const std::string& joint : poses.joints) {
      if (const auto position = sample.position(joint)) positions.push_back(*position);
    }
    if (positions.size() == joints.size()) poses.positions.push_back(std::move(positions));
  }
  return poses;
}

}  // namespace kinecal
