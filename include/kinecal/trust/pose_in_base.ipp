// The pose of a frame in the base, at any joint positions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <utility>

#include "kinecal/trust/pose_uncertainty.hpp"

namespace kinecal::detail {

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

}  // namespace kinecal::detail
