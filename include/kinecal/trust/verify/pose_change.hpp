// The difference between two calibrations in the pose of one link in another: the gripper in the
// camera's frame.
//
// Parameters trade off against each other, but a robot needs a pose:
//
//   T_i = in_T_frame(values of i)      position |t_1 - t_2|, rotation |log(R_1^T R_2)|
//
// at the joint positions of some samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/trust/uncertainty/pose_uncertainty.hpp"

namespace kinecal {

/// Change of the pose of a frame in another, over some poses of the robot.
struct PoseChange {
  int poses = 0;                ///< number of poses with all joints of both chains
  double position = 0.0;        ///< root of the mean squared distance of the origins, metres
  double rotation = 0.0;        ///< the same of the angles, radians
  double worst_position = 0.0;  ///< the largest, metres
  double worst_rotation = 0.0;  ///< the largest, radians
};

/// Change of the pose of a frame in another.
/// @param samples  poses at which it is computed; skips those that lack a joint of a chain
/// @throws RobotError  if a link does not exist, or no chain connects the two
[[nodiscard]] PoseChange pose_change(const RobotState& before, const RobotState& after,
                                     std::span<const Sample> samples, const FrameOnRobot& frame,
                                     const FrameOnRobot& in);

}  // namespace kinecal
