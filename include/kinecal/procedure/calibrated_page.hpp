// The page of a calibrated robot: its report with charts and the robot in 3-D.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/report/report_data.hpp"
#include "kinecal/report/robot_scene.hpp"

namespace kinecal {

/// What a page says of its making, and where it finds more.
struct PageOptions {
  std::string version = {};            ///< "kinecal 0.2.0"
  std::string date = {};               ///< "2026-11-23"
  ShellCommand command = {};           ///< repeats the run
  std::vector<InputFile> inputs = {};  ///< with checksums
  std::vector<std::string> mesh_paths =
      {};  ///< folders of packages, beside the environment and the URDF's folder
  std::vector<std::string> recordings = {};  ///< whose clouds are shown
};

/// The scene of a calibration, with the meshes found.
/// @param mesh_paths   folders of packages, beside the environment and the URDF's folder
/// @param diagnostics  receives warnings about meshes that are not found
[[nodiscard]] RobotScene calibrated_scene(const CalibratedRobot& calibrated,
                                          const std::vector<std::string>& mesh_paths,
                                          Diagnostics& diagnostics, const SceneLimits& limits = {});

/// What is reported of a calibration.
[[nodiscard]] ReportData calibrated_data(const CalibratedRobot& calibrated);

/// The page, HTML that needs nothing else.
/// @param diagnostics  like calibrated_scene()
[[nodiscard]] std::string calibrated_page(const CalibratedRobot& calibrated,
                                          const PageOptions& options, Diagnostics& diagnostics);

}  // namespace kinecal
