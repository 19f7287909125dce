// The measured pose of a floating joint in a sample: for sample_builder.ipp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/files/samples/sample_schema.ipp"
#include "kinecal/text/counted.hpp"

namespace kinecal::detail {

/// Collects the numbers of a pose.
class SamplePose {
 public:
  /// @param node  pose_xyz_item or pose_quaternion_item
  void number(SampleNode node, double value) {
    (node == SampleNode::pose_xyz_item ? xyz_ : xyzw_).push_back(value);
  }

  /// The pose of the numbers.
  /// @returns  what is wrong with them; empty: nothing
  [[nodiscard]] std::string read(Pose<double>& pose) const {
    if (xyz_.size() != 3) return "xyz has " + counted(xyz_.size(), "number") + ", not 3";
    if (xyzw_.size() != 4) {
      return "quaternion_xyzw has " + counted(xyzw_.size(), "number") + ", not 4";
    }
    pose.translation = Vector3<double>::Map(xyz_.data());
    const Eigen::Vector4d quaternion = Eigen::Vector4d::Map(xyzw_.data());
    const auto rotation = rotation_from_rounded_quaternion(quaternion);
    if (!rotation) return not_unit_text(quaternion.norm());
    pose.rotation = *rotation;
    const std::string far = far_away_text(pose.translation);
    return far.empty() ? "" : far + "; write metres";
  }

 private:
  std::vector<double> xyz_, xyzw_;
};

}  // namespace kinecal::detail
