// The calibrated pose of a camera, in the forms that programs of hand-eye calibrations read:
//
//   <joint>.xml          the joint of a URDF
//   <joint>.sh           the call of tf2_ros static_transform_publisher
//   <joint>.launch.py    the same as a launch file, as MoveIt Calibration writes it
//   <joint>.launch       the same for ROS 1
//   <joint>.txt          parent_T_child as a 4 x 4 matrix
//   <joint>.easy_handeye.yaml    calibration file of easy_handeye
//   <joint>.calib        calibration file of easy_handeye2
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/files/results/output_file.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

class ParameterTable;

/// The files of each calibrated fixed joint, if the samples have measured poses of a floating joint: of
/// hand-eye calibrations.  Others get none: their URDF has it all.
/// @param robot  before the calibration
[[nodiscard]] std::vector<OutputFile> transform_files(const Robot& robot,
                                                      const ParameterTable& table,
                                                      std::span<const Sample> samples);

}  // namespace kinecal
