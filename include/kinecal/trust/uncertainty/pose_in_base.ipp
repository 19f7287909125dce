// The pose of a frame in the base, at any joint positions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "kinecal/trust/uncertainty/pose_uncertainty.hpp"

namespace kinecal::detail {

/// The pose of a frame in the base, at any joint positions.
class PoseInBase {
 public:
  PoseInBase(const RobotState& robot, const FrameOnRobot& frame)
      : chain_(robot.problem.robot(), chain_to(robot.problem, frame), robot.problem.table()),
        corrections_(corrections_for(chain_.parameters(), robot.values)) {}
  [[nodiscard]] bool has_joints(const Sample& sample) const { return chain_.has_joints(sample); }
  [[nodiscard]] Pose<double> at(const Sample& sample) const {
    return chain_.tip(sample, corrections_);
  }

 private:
  [[nodiscard]] static RuntimeChain chain_to(const AnyProblem& problem, const FrameOnRobot& frame) {
    RuntimeChain chain = make_chain(problem.robot(), problem.base(), frame.link, problem.frames());
    return frame.frame.empty() ? chain : with_virtual_frame(std::move(chain), frame.frame);
  }

  SampledChain chain_;
  Corrections<double> corrections_;
};

}  // namespace kinecal::detail
