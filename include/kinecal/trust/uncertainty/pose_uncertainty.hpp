// The uncertainty of the pose of one link in another: the gripper in the camera's frame.
//
// Parameters trade off against each other, but a robot needs a pose.  Its covariance is
//
//   J C J^T      J (6 x free) from the twists of both chains, at the joint positions of the samples
//
// of the origin of one frame in the other, links or virtual frames (a tracker, a checkerboard).
//
// Source: Siciliano et al., Robotics: Modelling, Planning and Control, 3.1, for J.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "kinecal/samples/sample.hpp"
#include "kinecal/trust/uncertainty/uncertainty.hpp"

namespace kinecal {

/// A link, or a virtual frame beyond it.
struct FrameOnRobot {
  std::string link;        ///< of the robot
  std::string frame = {};  ///< virtual frame beyond it; empty: the link itself

  /// Its name.
  [[nodiscard]] const std::string& name() const { return frame.empty() ? link : frame; }
};

/// A robot with its parameters; needs no samples.
struct RobotState {
  const AnyProblem& problem;  ///< robot, base and frames
  ParameterValues values;     ///< of all parameters of its table
};

/// Uncertainty of the pose of a frame in another, over the poses of the samples.
struct PoseUncertainty {
  std::string frame;            ///< the link or virtual frame
  std::string in;               ///< the one in which its pose is given
  std::string link = {};        ///< the link of `frame`
  std::string in_link = {};     ///< the link of `in`
  double position = 0.0;        ///< root of the mean variance of its origin, metres: sqrt(trace)
  double rotation = 0.0;        ///< the same of its orientation, radians
  double worst_position = 0.0;  ///< at the worst pose of the samples, metres
  double worst_rotation = 0.0;  ///< the same, radians
  double elsewhere =
      0.0;  ///< of its origin over the limits of the joints, median, metres; 0: unknown
  bool determined = true;  ///< false: an undetermined direction moves its origin
};

/// Uncertainty of the pose of a frame in another.
/// @param values   of all parameters of the table
/// @param samples  poses at which it is computed; skips those that lack a joint of the chain
/// @throws RobotError  if a link does not exist, or no chain connects the two
[[nodiscard]] PoseUncertainty pose_uncertainty(const AnyProblem& problem, const FreeSet& free,
                                               ParameterValues values, const LinearFit& fit,
                                               const Uncertainty& known,
                                               std::span<const Sample> samples,
                                               const FrameOnRobot& frame, const FrameOnRobot& in);

/// Maps parameter uncertainty to the position of a frame in another: the mean of J^T J over poses,
/// J (3 x free) its derivative.  The mean variance of the position is trace(goal C).
/// @param samples  poses; skips those that lack a joint of the chain
/// @returns  (free x free), square metres by the units of the parameters
/// @throws RobotError  as pose_uncertainty()
[[nodiscard]] PlainMatrix position_goal(const AnyProblem& problem, const FreeSet& free,
                                        ParameterValues values, std::span<const Sample> samples,
                                        const FrameOnRobot& frame, const FrameOnRobot& in);

}  // namespace kinecal
