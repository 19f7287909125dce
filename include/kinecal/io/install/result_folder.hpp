// The result of a calibration, read back from the folder that it was written to.
//
//   calibration[_<date>].yaml   values by name, and the names of the other files: urdf, depth_info,
//                               rgb_info; of further cameras left_depth_info and so on
//   report.json                 whether it converged
//
// The date is that of the files' names; without one, the time at which they were written.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/stat.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/io/cameras/read_camera_file.hpp"
#include "kinecal/io/config/config_scalar.hpp"
#include "kinecal/io/diagnostics.hpp"
#include "kinecal/io/results/file_set.hpp"
#include "kinecal/io/text_file.hpp"
#include "kinecal/io/urdf/read_urdf.hpp"
#include "kinecal/io/yaml/yaml_documents.hpp"

namespace kinecal {

struct ResultCamera {
  std::string prefix;  ///< of its keys: empty, or "left_" of a further camera
  bool depth = false;  ///< depth_info, else rgb_info
  std::string name;    ///< as the file says: camera_name
  OutputFile file;
};

struct ResultFolder {
  std::string date;  ///< Y_m_d_H_M_S
  OutputFile urdf, values;
  std::vector<ResultCamera> cameras;
  std::map<std::string, double> parameters;
  std::optional<bool> converged;  ///< nothing without a report
};

namespace detail {

/// The date at the end of a name such as calibration_2026_11_21_20_47_57; empty if there is none.
[[nodiscard]] inline std::string date_in_name(const std::string& stem) {
  const std::string shape = "_dddd_dd_dd_dd_dd_dd";
  if (stem.size() < shape.size()) return {};
  const std::string end = stem.substr(stem.size() - shape.size());
  const bool is_date = std::equal(end.begin(), end.end(), shape.begin(), [](char c, char s) {
    return s == 'd' ? c >= '0' && c <= '9' : c == s;
  });
  return is_date ? end.substr(1) : std::string();
}

/// When a file was written, local time, Y_m_d_H_M_S.
[[nodiscard]] inline std::string date_of_file(const std::filesystem::path& path) {
  struct stat status = {};
  std::tm time = {};
  char text[64] = "";
  if (::stat(path.c_str(), &status) != 0 || ::localtime_r(&status.st_mtime, &time) == nullptr ||
      std::strftime(text, sizeof text, "%Y_%m_%d_%H_%M_%S", &time) == 0) {
    throw InputError(path.string() + ": the time at which it was written cannot be read");
  }
  return text;
}

/// The map in a YAML or JSON file.
/// @throws InputError  if the file is not there, not YAML or no map
[[nodiscard]] inline YAML::Node yaml_map(const std::string& text, const std::string& path) {
  try {
    const std::vector<YAML::Node> documents = load_yaml_documents(text);
    if (documents.size() == 1 && documents[0].IsMap()) return documents[0];
  } catch (const YAML::Exception& error) {
    throw InputError(Place{path, error.mark.line + 1}.str() + ": " + error.msg);
  }
  throw InputError(path + ": is not a map of names and values");
}

/// The calibration file of a folder; of several dated ones the newest, which the report is about.
[[nodiscard]] inline std::filesystem::path values_file(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> plain, dated;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string stem = entry.path().stem().string();
    if (entry.path().extension() != ".yaml") continue;
    if (stem == "calibration") plain.push_back(entry.path());
    if (stem == "calibration_" + date_in_name(stem)) dated.push_back(entry.path());
  }
  if (error) throw InputError(folder.string() + ": cannot be read: " + error.message());
  if (plain.empty() && dated.empty()) {
    throw InputError(folder.string() +
                     ": has no calibration.yaml; give the folder that 'kinecal calibrate' wrote");
  }
  if (!plain.empty() && !dated.empty()) {
    throw InputError(folder.string() + ": has both calibration.yaml and " +
                     dated[0].filename().string() + "; keep the result that is to be installed");
  }
  return plain.empty() ? *std::max_element(dated.begin(), dated.end()) : plain[0];
}

/// A file that calibration.yaml names, with its content.
[[nodiscard]] inline OutputFile named_file(const std::filesystem::path& folder,
                                           const std::string& values, const YAML::Node& name) {
  const std::filesystem::path path = folder / name.Scalar();
  if (!std::filesystem::exists(path)) {
    throw InputError(Place{values, name.Mark().line + 1}.str() + ": " + name.Scalar() +
                     " is not there; the result is incomplete");
  }
  return {path.filename().string(), read_text_file(path)};
}

/// left_depth_info: a camera file with the prefix "left_"; nothing for any other key.
[[nodiscard]] inline std::optional<ResultCamera> camera_key(const std::string& key) {
  for (const std::string kind : {"depth_info", "rgb_info"}) {
    if (!key.ends_with(kind)) continue;
    const std::string prefix = key.substr(0, key.size() - kind.size());
    if (!prefix.empty() && !prefix.ends_with('_')) continue;
    return ResultCamera{prefix, kind == "depth_info", "", {}};
  }
  return std::nullopt;
}

/// What a camera file calls its camera; empty if it does not.
/// @throws InputError  if a driver could not load the file
[[nodiscard]] inline std::string camera_name(const std::string& text,
                                             const std::filesystem::path& path) {
  Diagnostics diagnostics;
  (void)read_camera_file(path.string(), diagnostics);
  diagnostics.throw_if_errors();
  const YAML::Node name = yaml_map(text, path.string())["camera_name"];
  return name && name.IsScalar() ? name.Scalar() : std::string();
}

[[nodiscard]] inline std::optional<bool> read_converged(const std::filesystem::path& report) {
  if (!std::filesystem::exists(report)) return std::nullopt;
  const YAML::Node converged = yaml_map(read_text_file(report), report.string())["converged"];
  const auto flag = converged ? config_flag(converged) : std::nullopt;
  if (!flag) throw InputError(report.string() + ": does not say whether the result converged");
  return flag;
}

}  // namespace detail

/// Reads a result; the URDF and the camera files are read as a robot would, so that nothing broken
/// is installed.
/// @throws InputError  if something is missing or broken
[[nodiscard]] inline ResultFolder read_result_folder(const std::filesystem::path& folder) {
  const std::filesystem::path path = detail::values_file(folder);
  ResultFolder result;
  result.values = {path.filename().string(), read_text_file(path)};
  result.date = detail::date_in_name(path.stem().string());
  if (result.date.empty()) result.date = detail::date_of_file(path);
  std::filesystem::path urdf_path;
  for (const auto& pair : detail::yaml_map(result.values.content, path.string())) {
    if (!pair.first.IsScalar() || !config_text(pair.second)) continue;
    const std::string key = pair.first.Scalar();
    if (const auto value = config_number(pair.second)) {
      result.parameters[key] = *value;
    } else if (key == "urdf") {
      result.urdf = detail::named_file(folder, path.string(), pair.second);
      urdf_path = folder / pair.second.Scalar();
    } else if (auto camera = detail::camera_key(key)) {
      camera->file = detail::named_file(folder, path.string(), pair.second);
      camera->name = detail::camera_name(camera->file.content, folder / pair.second.Scalar());
      result.cameras.push_back(*camera);
    }
  }
  if (result.urdf.name.empty()) throw InputError(path.string() + ": names no urdf");
  (void)parse_urdf(result.urdf.content, urdf_path.string());
  result.converged = detail::read_converged(folder / "report.json");
  return result;
}

}  // namespace kinecal
