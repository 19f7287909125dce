// Comparing poses.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/verify/pose_change.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "kinecal/trust/uncertainty/pose_in_base.ipp"

namespace kinecal {

PoseChange pose_change(const RobotState& before, const RobotState& after,
                       std::span<const Sample> samples, const FrameOnRobot& frame,
                       const FrameOnRobot& in) {
  const detail::PoseInBase frame_before(before, frame), in_before(before, in),
      frame_after(after, frame), in_after(after, in);
  PoseChange change;
  for (const Sample& sample : samples) {
    if (!frame_before.has_joints(sample) || !in_before.has_joints(sample) ||
        !frame_after.has_joints(sample) || !in_after.has_joints(sample)) {
      continue;
    }
    const Pose<double> was = in_before.at(sample).inverse() * frame_before.at(sample);
    const Pose<double> is = in_after.at(sample).inverse() * frame_after.at(sample);
    const double position = (was.translation - is.translation).norm();
    const double rotation =
        Eigen::AngleAxisd(Matrix3<double>(was.rotation.transpose() * is.rotation)).angle();
    ++change.poses;
    change.position += position * position;
    change.rotation += rotation * rotation;
    change.worst_position = std::max(change.worst_position, position);
    change.worst_rotation = std::max(change.worst_rotation, rotation);
  }
  if (change.poses == 0) return change;
  change.position = std::sqrt(change.position / change.poses);
  change.rotation = std::sqrt(change.rotation / change.poses);
  return change;
}

}  // namespace kinecal
