// The scales of a mobile base: base_calibration.yaml, under the keys of base_calibration of robot_calibration.
//
//   track_width_scale: 1.0203  # +- 0.0004      the true track width over the nominal one
//   rollout_scale: 0.9801  # +- 0.0003          what a wheel rolls, true over nominal
//   imu_scale: 0.9798  # +- 0.0005              the true rate over that of the gyroscope
//
// Further parameters of the drive have their own names (left_rollout_scale, steering_offset), and the gyroscope's bias is
// imu_bias, rad/s.  Multiply what the driver has by a scale.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace kinecal {

struct Calibration;
class ParameterTable;

/// The content of the file; empty if no error block is of a base.  Of two blocks with the same key, the first counts.
/// @param deviations  standard deviations by table index; infinite: not determined
[[nodiscard]] std::string base_calibration_yaml(const Calibration& calibration,
                                                const ParameterTable& table,
                                                const std::map<int, double>& deviations);

}  // namespace kinecal
