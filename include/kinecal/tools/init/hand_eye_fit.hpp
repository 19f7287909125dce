// The pose of a camera from poses of a flange and of an object in the camera, in closed form: whether they are those of a camera
// on the hand or of one beside the robot.
//
//   A X = X B,  B = O_i O_j^-1,  A = F_i^-1 F_j on the hand,  A = F_i F_j^-1 beside the robot
//   rotation:     the nearest to  log R_A = R_X log R_B  of all pairs
//   translation:  (R_A - I) t_X = R_X t_B - t_A, by least squares
//
// calibrate() needs no such start: it finds one by itself.
// Source: Park, Martin, Robot sensor calibration: solving AX = XB on the Euclidean group, 1994.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A camera that explains pairs of poses.
struct HandEyeFit {
  Pose<double> mount;       ///< flange_T_camera or base_T_camera, metres
  double difference = 0.0;  ///< root mean square of the equation for the translation, metres
  double turn = 0.0;        ///< the same for the rotation, radians
};

/// The fit of all pairs of samples.
/// @param samples  as read_hand_eye_samples() returns them
/// @returns        not a number if there are no two samples
[[nodiscard]] HandEyeFit fit_hand_eye(std::span<const Sample> samples, bool camera_on_hand);

}  // namespace kinecal
