// The scales of a mobile base: base_calibration.yaml, under the keys of base_calibration of robot_calibration.
//
//   track_width_scale: 1.0203  # +- 0.0004      the true track width over the nominal one
//   rollout_scale: 0.9801  # +- 0.0003          what a wheel rolls, true over nominal
//   imu_scale: 0.9798  # +- 0.0005              the true rate over that of the gyroscope
//   odom: 0.390131                              in ROS 1: what the driver's track width should be
//   imu: 0.00119705                             in ROS 1: what the driver's scale of the gyroscope should be
//
// Since version 0.10, base_calibration writes scales; before, it wrote `odom` and `imu`, the scales times what the driver has,
// which Fetch's installer reads.  They are here if the error block says what the driver has (track_width, gyro_scale).
// ROS 1 does not calibrate the rollout, so `odom` is the track width with which turns are right while wheels keep theirs:
// track_width_scale over rollout_scale.  (ROS 1 itself multiplies by the true turn over that of the odometry, which is its
// reciprocal.)
//
// Further parameters of the drive have their own names (left_rollout_scale, steering_offset), and the gyroscope's bias is
// imu_bias, rad/s.  Multiply what the driver has by a scale.
// Source: robot_calibration, base_calibration.cpp; fetch_calibration, calibrate_robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace kinecal {

struct Calibration;
class ParameterTable;

/// The content of the file; empty if no error block is of a base.  Of two blocks with the same key, the first counts.
/// What samples do not determine is a comment: any value would fit.  Then `odom` and `imu` are left out, too.
/// @param deviations  standard deviations by table index; infinite: not determined
/// @param drivers     what the driver has, by error block: its track width, metres, or its scale of the gyroscope; those that
///                    are not positive are not known
[[nodiscard]] std::string base_calibration_yaml(const Calibration& calibration,
                                                const ParameterTable& table,
                                                const std::map<int, double>& deviations,
                                                const std::map<std::string, double>& drivers = {});

}  // namespace kinecal
