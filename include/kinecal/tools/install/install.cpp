// The steps of an installation: definitions of install.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/install/install.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "kinecal/files/launch/launch_text.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/sensors/depth/depth_polynomial.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/install/dates.ipp"
#include "kinecal/tools/install/launch_folder.ipp"
#include "kinecal/tools/install/launch_names.hpp"
#include "kinecal/tools/install/result_folder.hpp"

namespace kinecal {

namespace detail {
namespace {

// The settings of a calibration in a robot's launch file.
//
//   calibration_date               <param value>     Y-m-d H:M:S
//   robot_description              <param textfile>  the URDF's path
//   z_offset_mm                    <param value>     int(1000 z_offset), towards zero: the driver
//                                                    takes whole millimetres
//   z_scaling                      <param value>     1 + z_scaling
//   depth_, rgb_camera_info_url    <arg default>     file://<path>
//   track_width, gyro_scale        <param value>     odom and imu of base_calibration.yaml
//
// If the result lacks z_offset or z_scaling for a depth camera, the camera was calibrated without
// depth correction, whatever its driver used during recording: 0 and 1 are set.
// Source: Fetch paper, III-C; calibrate_robot of fetch_calibration.

/// The files of a result under their names on the robot.
struct InstalledFiles {
  OutputFile urdf;                  ///< without a name: the result has no robot
  std::vector<OutputFile> cameras;  ///< as ResultFolder::cameras
};

/// A depth camera's parameter; zero if the result does not have it.  The prefix of parameters may
/// differ from the camera's name: with one depth camera, the only parameter with this ending is
/// used.
/// @param ending  such as "_z_offset"
[[nodiscard]] double depth_parameter(const ResultFolder& result, const ResultCamera& camera,
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
[[nodiscard]] std::string whole_millimetres(double metres, const std::string& file) {
  constexpr double kFarthest = 1e3;  // of a depth camera, metres
  if (std::abs(metres) < kFarthest) return fmt::format("{}", static_cast<int>(metres * 1000.0));
  throw InputError(fmt::format("{}: a z_offset of {} m is impossible; the largest is {} m", file,
                               metres, kFarthest));
}

/// A number as Python's str() has it, which Fetch's installer writes: "1.0e-05" is "1e-05" there.
[[nodiscard]] std::string python_number(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
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

/// The settings of a mobile base.
/// @param launch  the launch file as it is: Fetch's has no place for gyro_scale
void add_base_settings(const ResultFolder& result, const LaunchText& launch,
                       const LaunchNames& names, LaunchSettings& settings,
                       Diagnostics& diagnostics) {
  const auto& values = result.base_values;
  const auto value = [&](const char* key) {
    const auto found = values.find(key);
    return found == values.end() ? std::optional<double>() : found->second;
  };
  const auto set = [&](std::string_view key, const char* installed, const char* scale,
                       bool is_optional) {
    const std::optional<double> number = value(installed);
    const std::string name(names.at(std::string(key)));
    const LaunchSetting setting{std::string(key), LaunchElement::param, name, "value", ""};
    const bool is_default = fetch_launch_names().at(std::string(key)) == name;
    if (!number) {
      if (!value(scale) || name.empty()) return;
      diagnostics.warnings.push_back(fmt::format(
          "{} is not set: {} has {} {}, not {}; give the error block the driver's {} and calibrate "
          "again, or {} leaves it out",
          key, result.base.name, scale, python_number(*value(scale)), installed, key,
          name_option(std::string(key) + "=")));
    } else if (is_optional && is_default && !launch.has(setting)) {
      diagnostics.warnings.push_back(fmt::format(
          "{} is not set to {}: the launch file has no param '{}'; {} names another one", key,
          python_number(*number), name, name_option(std::string(key) + "=NAME")));
    } else {
      settings.add(setting.element, "", key, setting.attribute, python_number(*number));
    }
  };
  set(launch_key::kTrackWidth, "odom", "track_width_scale", false);
  set(launch_key::kGyroScale, "imu", "imu_scale", true);
  std::string rollout;
  for (const char* scale : {"rollout_scale", "left_rollout_scale", "right_rollout_scale"}) {
    if (value(scale).value_or(1.0) == 1.0) continue;
    rollout += fmt::format("{}{} {:.6g}", rollout.empty() ? "" : ", ", scale, *value(scale));
  }
  if (rollout.empty()) return;
  diagnostics.warnings.push_back(
      rollout +
      ": not set, as Fetch's launch file has no place for it; with the track width that is set, "
      "turns are right, and distances are not");
}

/// The settings of a result.
/// @param launch       the launch file as it is
/// @param folder       future folder of the files, an absolute path
/// @param diagnostics  receives a warning for each key without a name
/// @throws InputError  if a name or a value is unusable
[[nodiscard]] std::vector<LaunchSetting> launch_settings(
    const ResultFolder& result, const InstalledFiles& files, const LaunchText& launch,
    const std::filesystem::path& folder, const LaunchNames& names, Diagnostics& diagnostics) {
  LaunchSettings settings(names, diagnostics);
  constexpr LaunchElement kParam = LaunchElement::param, kArg = LaunchElement::arg;
  settings.add(kParam, "", launch_key::kDate, "value", date_for_people(result.date));
  if (result.has_robot) {
    settings.add(kParam, "", launch_key::kRobot, "textfile", (folder / files.urdf.name).string());
  } else {
    diagnostics.warnings.push_back(
        fmt::format("{} is left as it is: {} is of a sensor on one link, not of the robot",
                    launch_key::kRobot, result.urdf.name));
  }
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
  add_base_settings(result, launch, names, settings, diagnostics);
  return settings.take();
}

/// @throws InputError  for a file of parameters or a launch file of ROS 2, with what to enter there
void check_is_of_ros1(const std::string& launch, const ResultFolder& result) {
  const std::string extension = std::filesystem::path(launch).extension().string();
  if (extension != ".yaml" && extension != ".yml" && extension != ".py") return;
  throw InputError(
      "launch file '" + launch +
      "': is one of ROS 2, where nothing has a fixed name; install sets launch files of ROS 1" +
      (result.base.name.empty()
           ? ""
           : ".  Of a base, enter the scales of " + result.base.name +
                 ": diff_drive_controller takes track_width_scale as wheel_separation_multiplier, "
                 "and rollout_scale as left_wheel_radius_multiplier and "
                 "right_wheel_radius_multiplier"));
}

/// The result's files, with this date in their names.
[[nodiscard]] InstalledFiles dated_files(const ResultFolder& result, const std::string& date) {
  InstalledFiles files;
  if (result.has_robot) files.urdf = {with_date(result.urdf.name, date), result.urdf.content};
  for (const ResultCamera& camera : result.cameras) {
    files.cameras.push_back({with_date(camera.file.name, date), camera.file.content});
  }
  return files;
}

[[nodiscard]] std::vector<OutputFile> list(const InstalledFiles& files) {
  std::vector<OutputFile> all = files.cameras;
  if (!files.urdf.name.empty()) all.push_back(files.urdf);
  return all;
}

/// The result's files under unused names.  A second result of the same second gets the suffix _2.
[[nodiscard]] InstalledFiles files_for(const ResultFolder& result,
                                       const std::filesystem::path& folder) {
  for (int n = 1;; ++n) {
    const std::string date = n == 1 ? result.date : result.date + "_" + std::to_string(n);
    InstalledFiles files = dated_files(result, date);
    bool is_free = true;
    for (const OutputFile& file : list(files)) {
      const std::filesystem::path path = folder / file.name;
      is_free = is_free && (!std::filesystem::exists(path) || read_text_file(path) == file.content);
    }
    if (is_free) return files;
  }
}

/// Rejects a launch file that names missing files of its folder.
void check_named_files(const std::filesystem::path& launch) {
  std::string missing;
  for (const std::filesystem::path& file :
       LaunchText(read_text_file(launch), launch.string()).named_files()) {
    std::error_code no_such_folder;
    const bool is_ours =
        std::filesystem::equivalent(file.parent_path(), launch.parent_path(), no_such_folder);
    if (!is_ours || std::filesystem::exists(file)) continue;
    missing += (missing.empty() ? "" : ", ") + file.filename().string();
  }
  if (missing.empty()) return;
  throw InputError(launch.string() + ": names files that no longer exist: " + missing +
                   "; nothing was restored, --force restores it anyway");
}

}  // namespace
}  // namespace detail

Installation install(const ResultFolder& result, const std::filesystem::path& folder,
                     const std::string& launch, const LaunchNames& names,
                     Diagnostics& diagnostics) {
  detail::LaunchFolder target(folder, launch);
  detail::check_is_of_ros1(launch, result);
  target.remove_leftovers();
  const detail::LaunchText old(detail::read_text_file(target.launch()), target.launch().string());
  const detail::InstalledFiles files = detail::files_for(result, target.path());
  const std::string text =
      old.with(detail::launch_settings(result, files, old, target.path(), names, diagnostics));
  std::vector<OutputFile> added;
  for (const OutputFile& file : detail::list(files)) {
    if (!std::filesystem::exists(target.path() / file.name)) added.push_back(file);
  }
  Installation done;
  for (const OutputFile& file : added) done.added.push_back(file.name);
  if (text != old.text()) {
    if (target.launch_is_link()) {
      diagnostics.warnings.push_back(
          target.launch().string() + ": is a symbolic link to " +
          std::filesystem::read_symlink(target.launch()).string() +
          "; a file replaces the link, and what it names stays as it is");
    }
    done.backup = target.replace_launch(added, text);
  } else if (!added.empty()) {
    target.add(added);
  }
  return done;
}

std::string restore_installed(const std::filesystem::path& folder, const std::string& launch,
                              bool force) {
  detail::LaunchFolder target(folder, launch);
  if (!force) detail::check_named_files(target.backup());
  return target.restore();
}

std::string reset_installed(const std::filesystem::path& folder, const std::string& launch,
                            const std::filesystem::path& factory) {
  const detail::LaunchText text(detail::read_text_file(factory), factory.string());
  detail::LaunchFolder target(folder, launch);
  target.remove_leftovers();
  if (detail::read_text_file(target.launch()) == text.text()) return {};
  return target.replace_launch({}, text.text());
}

std::string installed_date(const std::filesystem::path& folder, const std::string& launch,
                           const LaunchNames& names) {
  const detail::LaunchFolder target(folder, launch);
  const detail::LaunchText text(detail::read_text_file(target.launch()), target.launch().string());
  const std::string key(launch_key::kDate);
  const detail::LaunchSetting setting{key, detail::LaunchElement::param, names.at(key), "value",
                                      ""};
  Diagnostics diagnostics;
  std::string date = text.value_of(setting, diagnostics);
  diagnostics.throw_if_errors();
  return date;
}

}  // namespace kinecal
