// The output files of a calibration: the robot, its cameras, the values.
//
//   calibrated.urdf        the URDF, patched in place
//   depth_<camera>.yaml    camera_info of each depth camera, and
//   rgb_<camera>.yaml      of each colour camera
//   depth_correction_<camera>.yaml   of a depth camera with a polynomial: see depth_file.hpp
//   base_calibration.yaml  the scales of a mobile base: see base_file.hpp
//   magnetometer_calibration.yaml   hard and soft iron: see magnetometer_file.hpp
//   calibrated_<arm>.urdf, kinematics_<arm>.yaml   of several arms: see arm_files.hpp
//   <joint>.xml, ...       of a hand-eye calibration: see transform_files.hpp
//   calibration.yaml       lines `name: value`, then the names of the files above, for
//                          installers
//
// With upstream's names: calibrated_<date>.urdf, depth_[<camera>_]<date>.yaml and so on.  These
// omit the name of a camera called "camera".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/files/results/output_file.hpp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

struct Calibration;
struct CalibrationResult;
class ParameterTable;

/// Copies of what a result was calibrated with, so that its folder says all.
/// @{
inline constexpr const char* kOriginalUrdf = "original.urdf";
inline constexpr const char* kConfigCopy = "config.yaml";
/// @}

/// Options for result files.
struct ResultFileOptions {
  OffsetStyle offsets = OffsetStyle::rising;  ///< where the URDF holds joint offsets
  std::string date = {};  ///< Y_m_d_H_M_S for upstream's names; empty: kinecal's names
  /// Standard deviations by table index, units of the parameters; infinite: not determined.
  std::map<int, double> deviations = {};
  std::set<std::string> in_servos = {};  ///< joints whose zeros the URDF does not get
  /// What the driver of a base has, by error block: see base_calibration_yaml().
  std::map<std::string, double> drivers = {};
};

/// The calibration of each joint of the robot, from the parameter values.  Skips virtual frames,
/// which no URDF contains.
/// @param in_servos  joints whose zeros their servos get: without offset
[[nodiscard]] std::vector<JointPatch> joint_patches(const Robot& robot, const ParameterTable& table,
                                                    const std::set<std::string>& in_servos = {});

/// Why a calibrated camera is physically impossible, for example after one bad capture far away;
/// empty if all cameras are possible.
[[nodiscard]] std::string impossible_camera(const Calibration& calibration,
                                            const ParameterTable& table,
                                            std::span<const Sample> samples);

/// The files of a result, with their content.
/// @param urdf_text  content of the URDF, as it was read
/// @param urdf_name  its name in messages
[[nodiscard]] std::vector<OutputFile> result_files(const Robot& robot, const std::string& urdf_text,
                                                   const std::string& urdf_name,
                                                   const Calibration& calibration,
                                                   const CalibrationResult& result,
                                                   std::span<const Sample> samples,
                                                   const ResultFileOptions& options);

}  // namespace kinecal
