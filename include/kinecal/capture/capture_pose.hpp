// A pose in which samples are captured.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kinecal {

/// One pose, and the finders that look for features there.
struct CapturePose {
  std::vector<std::string>
      joint_names;                    ///< the joints that move there; none: wherever the robot is
  std::vector<double> positions;      ///< radians or metres, in the order of the names
  std::vector<std::string> features;  ///< names of the finders; none: all

  /// Equal names, positions and features.
  friend bool operator==(const CapturePose&, const CapturePose&) = default;
};

}  // namespace kinecal
