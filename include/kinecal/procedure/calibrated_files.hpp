// The files of a calibrated robot, as text: what a person installs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/results/output_file.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"

namespace kinecal {

/// All files of a calibration: calibrated.urdf first, then calibration.yaml, cameras, report.json and residuals.csv.
/// @throws InputError  if the setup has no URDF text, or it cannot hold the result
[[nodiscard]] std::vector<OutputFile> calibrated_files(const CalibratedRobot& calibrated,
                                                       ResultFileOptions options = {});

/// The calibrated URDF: the setup's, with the result.
/// @throws InputError  if the setup has no URDF text, or it cannot hold the result
[[nodiscard]] std::string calibrated_urdf(const CalibratedRobot& calibrated,
                                          const ResultFileOptions& options = {});

}  // namespace kinecal
