// The settings of a calibration in a robot's launch file.
//
//   calibration_date               <param value>     Y-m-d H:M:S
//   robot_description              <param textfile>  the URDF's path
//   z_offset_mm                    <param value>     int(1000 z_offset), towards zero: the driver
//                                                    takes whole millimetres
//   z_scaling                      <param value>     1 + z_scaling
//   depth_, rgb_camera_info_url    <arg default>     file://<path>
//
// If the result lacks z_offset or z_scaling for a depth camera, the camera was calibrated without
// depth correction, whatever its driver used during recording: 0 and 1 are set.
// Source: Fetch paper, III-C.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/sensors/depth_polynomial.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/install/dates.ipp"
#include "kinecal/tools/install/launch_names.hpp"
#include "kinecal/tools/install/launch_text.ipp"
#include "kinecal/tools/install/result_folder.hpp"

namespace kinecal::detail {

/// The files of a result under their names on the robot.
struct InstalledFiles {
  OutputFile urdf;
  std::vector<OutputFile> cameras;  ///< as ResultFolder::cameras
};

/// A depth camera's parameter; zero if the result does not have it.  The prefix of parameters may
/// differ from the camera's name: with one depth camera, the only parameter with this ending is
/// used.
/// @param ending  such as "_z_offset"
[[nodiscard]] inline double depth_parameter(const ResultFolder& result, const ResultCamera& camera,
                                            const std::string& ending) {
  const auto own = result.parameters.find(camera.name + ending);
  if (own != result.parameters.end()) return own->second;
  const auto is_depth = [](const ResultCamera& c) { return c.depth; };
  const auto ends_so = [&](const auto& value) { return value.first.ends_with(ending); };
  const auto& all = result.parameters;
  const bool is_only = std::count_if(result.cameras.begin(), result.cameras.end(), is_depth) == 1 &&
                       std::count_if(all.begin(), all.end(), ends_so) == 1;
  return is_only ? std::find_if(all.begin(), all.end(), ends_so)->second : 0.0;
}

/// z_offset in millimetres as an integer.
/// @param metres  the parameter
/// @param file    its source, for messages
[[nodiscard]] inline std::string whole_millimetres(double metres, const std::string& file) {
  constexpr double kFarthest = 1e3;  // of a depth camera, metres
  if (std::abs(metres) < kFarthest) return fmt::format("{}", static_cast<int>(metres * 1000.0));
  throw InputError(fmt::format("{}: a z_offset of {} m is impossible; the largest is {} m", file,
                               metres, kFarthest));
}

/// Collects settings for the keys that have a name.
class LaunchSettings {
 public:
  LaunchSettings(const LaunchNames& names, Diagnostics& diagnostics)
      : names_(names), diagnostics_(diagnostics) {}

  void add(LaunchElement element, const std::string& prefix, std::string_view key,
           const std::string& attribute, const std::string& value) {
    const std::string full = prefix + std::string(key);
    keys_.insert(full);
    const auto name = names_.find(full);
    if (name == names_.end()) {
      diagnostics_.warnings.push_back(full + " is not set: it has no name in the launch file; " +
                                      name_option(full + "=NAME") + " gives it one");
    } else if (!name->second.empty()) {
      settings_.push_back({full, element, name->second, attribute, value});
    }
  }

  /// @throws InputError  if a name is given for a key that this result lacks; Fetch's keys always
  ///                     have names
  [[nodiscard]] std::vector<LaunchSetting> take() {
    for (const auto& [key, name] : names_) {
      const auto& all = launch_key::kAll;
      if (keys_.contains(key) || std::find(all.begin(), all.end(), key) != all.end()) continue;
      throw InputError("name '" + key + "=" + name + "': the result has no '" + key + "'" +
                       did_you_mean(key, keys_));
    }
    return std::move(settings_);
  }

 private:
  const LaunchNames& names_;
  Diagnostics& diagnostics_;
  std::set<std::string> keys_;
  std::vector<LaunchSetting> settings_;
};

/// The settings of a result.
/// @param folder       future folder of the files, an absolute path
/// @param diagnostics  receives a warning for each key without a name
/// @throws InputError  if a name or a value is unusable
[[nodiscard]] inline std::vector<LaunchSetting> launch_settings(const ResultFolder& result,
                                                                const InstalledFiles& files,
                                                                const std::filesystem::path& folder,
                                                                const LaunchNames& names,
                                                                Diagnostics& diagnostics) {
  LaunchSettings settings(names, diagnostics);
  constexpr LaunchElement kParam = LaunchElement::param, kArg = LaunchElement::arg;
  settings.add(kParam, "", launch_key::kDate, "value", date_for_people(result.date));
  settings.add(kParam, "", launch_key::kRobot, "textfile", (folder / files.urdf.name).string());
  for (std::size_t i = 0; i < result.cameras.size(); ++i) {
    const ResultCamera& camera = result.cameras[i];
    const std::string url = "file://" + (folder / files.cameras[i].name).string();
    if (!camera.depth) {
      settings.add(kArg, camera.prefix, launch_key::kRgbInfo, "default", url);
      continue;
    }
    settings.add(kArg, camera.prefix, launch_key::kDepthInfo, "default", url);
    const double offset = depth_parameter(result, camera, "_z_offset");
    const double scaling = 1.0 + depth_parameter(result, camera, "_z_scaling");
    settings.add(kParam, camera.prefix, launch_key::kDepthOffset, "value",
                 whole_millimetres(offset, result.values.name));
    settings.add(kParam, camera.prefix, launch_key::kDepthScaling, "value",
                 number_to_yaml(scaling));
    const bool bends = std::any_of(kDepthPolynomial.begin(), kDepthPolynomial.end(), [&](auto& of) {
      return depth_parameter(result, camera, "_" + std::string(of.name)) != 0.0;
    });
    if (bends) {
      diagnostics.warnings.push_back(
          "camera '" + camera.name +
          "': its driver gets offset and scale of the depth, not the rest of the correction; apply "
          "the file depth_correction of the result with true_depth.hpp");
    }
  }
  return settings.take();
}

}  // namespace kinecal::detail
