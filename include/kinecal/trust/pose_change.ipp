// Comparing poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kinecal/trust/pose_change.hpp"

namespace kinecal {

namespace detail {

/// The pose of a frame in the base, at any joint positions.
class PoseInBase {
 public:
  PoseInBase(const RobotState& robot, const FrameOnRobot& frame)
      : chain_(make_chain(robot.problem.robot(), robot.problem.base(), frame.link,
                          robot.problem.frames())) {
    if (!frame.frame.empty()) chain_ = with_virtual_frame(std::move(chain_), frame.frame);
    corrections_ = corrections_for(chain_parameters(chain_, robot.problem.table()), robot.values);
  }
  [[nodiscard]] bool has_joints(const Sample& sample) const {
    return std::all_of(chain_.joints.begin(), chain_.joints.end(), [&](const ChainJoint& joint) {
      return !moves(joint.type) || sample.position(joint.drive.joint);
    });
  }
  [[nodiscard]] Pose<double> at(const Sample& sample) const {
    PoseWalker<double> walker;
    walk(chain_,
         measured_joint_states(chain_,
                               [&](const std::string& joint) { return *sample.position(joint); }),
         corrections_, walker);
    return walker.pose;
  }

 private:
  RuntimeChain chain_;
  Corrections<double> corrections_;
};

}  // namespace detail

KINECAL_INLINE PoseChange pose_change(const RobotState& before, const RobotState& after,
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
