// Reads the result of a calibration back from its folder.
//
//   calibration[_<date>].yaml   values by name, and the names of the other files: urdf, depth_info,
//                               rgb_info; for further cameras left_depth_info and so on; base
//   report.json                 whether the calibration converged, and the verdict
//
// The date is that in the name of calibration_<date>.yaml, or else the time at which
// calibration.yaml was written.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/results/output_file.hpp"

namespace kinecal {

/// A camera file of a result.
struct ResultCamera {
  std::string prefix;  ///< of its keys: empty, or "left_" for a further camera
  bool depth = false;  ///< depth_info, else rgb_info
  std::string name;    ///< camera_name in the file
  OutputFile file;     ///< camera_info
};

/// The files of a calibration.
struct ResultFolder {
  std::string date;                          ///< Y_m_d_H_M_S
  OutputFile urdf;                           ///< the calibrated URDF
  bool has_robot = true;                     ///< false: the URDF is a sensor on a link, of no robot
  OutputFile values;                         ///< the file of the parameters
  OutputFile report;                         ///< report.json; without a name if absent
  std::vector<ResultCamera> cameras;         ///< the calibrated cameras
  std::map<std::string, double> parameters;  ///< name and value: radians, metres or relative
  OutputFile base;                           ///< base_calibration.yaml; without a name if absent
  std::map<std::string, double> base_values;  ///< of that file: see files/results/base_file.hpp
  std::optional<bool> converged;              ///< nullopt if there is no report
  std::string refusal;                        ///< why not to use it, according to the report
};

/// Reads a result.  Parses the URDF and the camera files as a robot would, so that no broken file
/// is installed.
/// @throws InputError  if something is missing or broken
[[nodiscard]] ResultFolder read_result_folder(const std::filesystem::path& folder);

}  // namespace kinecal
