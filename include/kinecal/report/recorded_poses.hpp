// The joint positions at which a calibration was recorded, compact enough for its report.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

/// Joint positions of samples, for comparing calibrations at these poses.
struct RecordedPoses {
  std::vector<std::string> joints;             ///< of the chains of all sensors
  std::vector<std::vector<double>> positions;  ///< radians or metres, for each joint
  std::vector<std::string> floating = {};      ///< floating joints of these chains
  /// Of each sample, the measured poses of `floating`.
  std::vector<std::vector<Pose<double>>> measured = {};
};

/// The poses of samples with all joints and measured poses; an even selection if there are more than 100.
[[nodiscard]] RecordedPoses recorded_poses(const Calibration& calibration,
                                           std::span<const Sample> samples);

}  // namespace kinecal
