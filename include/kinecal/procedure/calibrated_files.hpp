// The files of a calibrated robot, as text: what a person installs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/results/output_file.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"

namespace kinecal {

/// All files of a calibration: calibrated.urdf first, then calibration.yaml, cameras, the others, residuals.csv, and report.json, which has
/// the checksums of the files that are read again.  Written in this order, a folder is known to be whole.
/// @param others  further files of the folder that are read again: copies of the inputs
/// @throws InputError  if the setup has no URDF text, or it cannot hold the result
[[nodiscard]] std::vector<OutputFile> calibrated_files(const CalibratedRobot& calibrated,
                                                       ResultFileOptions options = {},
                                                       std::vector<OutputFile> others = {});

/// The calibrated URDF: the setup's, with the result.
/// @throws InputError  if the setup has no URDF text, or it cannot hold the result
[[nodiscard]] std::string calibrated_urdf(const CalibratedRobot& calibrated,
                                          const ResultFileOptions& options = {});

}  // namespace kinecal
