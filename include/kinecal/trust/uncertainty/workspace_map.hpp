// A map of the uncertainty of a pose over the robot's workspace: how far the gripper will be off in
// the camera's view, also where no sample was taken.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kinecal/trust/assess.hpp"

namespace kinecal {

/// A place in the workspace, and the uncertainty of a position when the robot is there.
struct KnownPoint {
  std::array<double, 3>
      p_base{};            ///< of the frame in question, in the base, metres; of the other frame
                           ///< if only that one moves: a camera that sees a board
  double deviation = 0.0;  ///< standard deviation of the position, metres: sqrt(trace)
};

/// The uncertainty of a pose, by an assessed step, at poses spread evenly over the limits of the joints
/// that move it; a joint without limits, or with wider ones, moves over a turn or a metre.
/// @param pose    its frames
/// @param values  of all parameters of the table: the solution
/// @param poses   their number
/// @returns       empty if the step frees nothing, or if some joint drives nothing known
/// Source: Halton, On the efficiency of certain quasi-random sequences of points, 1960, for the
/// poses.
[[nodiscard]] std::vector<KnownPoint> workspace_map(const AnyProblem& problem,
                                                    const Assessment& step,
                                                    const PoseUncertainty& pose,
                                                    ParameterValues values, int poses);

}  // namespace kinecal
