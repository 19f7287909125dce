// Sizes of the errors of simulated robots.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// Sizes of a robot's errors: each is drawn between half of its size and all of it, with either
/// sign.
struct ErrorSizes {
  double joint = 0.05;       ///< of joints that turn, radians
  double sliding = 0.01;     ///< of other joints, metres
  double position = 0.01;    ///< of frames, metres
  double rotation = 0.02;    ///< of frames, radians
  double intrinsics = 0.01;  ///< of focal lengths and principal point, relative
  double z_offset = 0.005;   ///< of depth, metres
  double z_scaling = 0.01;   ///< of depth, relative
  double z_bend = 0.005;     ///< of the further terms of depth, 1/m or relative
};

/// The size of a parameter's error, by its name; zero for an unknown kind.
[[nodiscard]] double error_size(const Robot& robot, const std::string& parameter,
                                const ErrorSizes& sizes);

}  // namespace kinecal
