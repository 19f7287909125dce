// A pose in which samples are captured.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kinecal {

/// One pose, and the finders to run in it.
struct CapturePose {
  std::vector<std::string> joint_names;  ///< the joints to move; empty: the robot stays where it is
  std::vector<double> positions;         ///< radians or metres, in the order of the names
  std::vector<std::string> features;     ///< names of the finders; empty: all
  std::string source = {};               ///< "poses.yaml:3", for messages; empty if not from a file

  /// Equal names, positions and features; ignores the source.
  friend bool operator==(const CapturePose& a, const CapturePose& b) {
    return a.joint_names == b.joint_names && a.positions == b.positions && a.features == b.features;
  }
};

}  // namespace kinecal
