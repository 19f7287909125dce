// Reads a result: definitions of result_folder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/install/result_folder.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/files/checksum.hpp"
#include "kinecal/files/json/json_value.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/yaml/config_scalar.hpp"
#include "kinecal/files/yaml/yaml_node.hpp"
#include "kinecal/tools/install/dates.ipp"

namespace kinecal {

namespace detail {
namespace {

/// The map in a YAML or JSON file.
/// @throws InputError  if the text is not YAML or not a map
[[nodiscard]] YamlNode yaml_map(const std::string& text, const std::string& path) {
  std::vector<YamlNode> documents = parse_yaml(text, path);
  if (documents.size() == 1 && documents[0].is_map()) return std::move(documents[0]);
  throw InputError(path + ": is not a map of names and values");
}

/// The entries of a map that are numbers.
[[nodiscard]] std::map<std::string, double> number_entries(const YamlNode& map) {
  std::map<std::string, double> numbers;
  for (std::size_t i = 0; i < map.keys.size(); ++i) {
    const auto value = config_number(map.items[i]);
    if (map.keys[i].is_scalar() && value) numbers[map.keys[i].text] = *value;
  }
  return numbers;
}

/// The calibration file of a folder; if there are several, the newest, which report.json describes.
[[nodiscard]] std::filesystem::path values_file(const std::filesystem::path& folder) {
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

/// A file named in calibration.yaml, with its content.
[[nodiscard]] OutputFile named_file(const std::filesystem::path& folder, const std::string& values,
                                    const YamlNode& name) {
  const std::filesystem::path path = folder / name.text;
  if (!std::filesystem::exists(path)) {
    throw InputError(SourceLocation{values, name.line}.str() + ": " + name.text +
                     " is not there; the result is incomplete");
  }
  return {path.filename().string(), read_text_file(path)};
}

/// The camera of a key such as left_depth_info, prefix "left_"; nullopt for other keys.
[[nodiscard]] std::optional<ResultCamera> camera_key(const std::string& key) {
  for (const std::string kind : {"depth_info", "rgb_info"}) {
    if (!key.ends_with(kind)) continue;
    const std::string prefix = key.substr(0, key.size() - kind.size());
    if (!prefix.empty() && !prefix.ends_with('_')) continue;
    return ResultCamera{prefix, kind == "depth_info", "", {}};
  }
  return std::nullopt;
}

/// The name of the camera in a camera file; empty if the file has none.
/// @throws InputError  if a driver could not load the file
[[nodiscard]] std::string camera_name(const std::string& text, const std::filesystem::path& path) {
  Diagnostics diagnostics;
  (void)read_camera_file(path.string(), diagnostics);
  diagnostics.throw_if_errors();
  const YamlNode file = yaml_map(text, path.string());
  const YamlNode* name = file.find("camera_name");
  return name != nullptr ? name->text : std::string();
}

/// Checks that the files are those of the report: a run that is killed while it replaces them leaves some of
/// each.  A report of an older version has no checksums.
/// @throws InputError  if one is of another run, or was changed
void check_is_whole(const std::filesystem::path& folder, const JsonValue& report,
                    const ResultFolder& result) {
  if (!report.find("files")) return;
  std::map<std::string, std::string> checksums;
  for (const JsonValue& file : report.list("files")) {
    checksums.emplace(file.text("name"), file.text("sha256"));
  }
  if (checksums.empty()) return;
  const auto check = [&](const std::string& name, const std::string& content) {
    const auto of = checksums.find(name);
    if (of != checksums.end() && of->second == sha256_text(content)) return;
    throw InputError((folder / name).string() +
                     ": is not the file that report.json was written with: a run was interrupted "
                     "while it replaced the results, or the file was changed; calibrate again");
  };
  for (const char* copy : {kOriginalUrdf, kConfigCopy}) {
    if (checksums.contains(copy) && std::filesystem::is_regular_file(folder / copy)) {
      check(copy, read_text_file(folder / copy));
    }
  }
  check(result.values.name, result.values.content);
  check(result.urdf.name, result.urdf.content);
  if (!result.base.name.empty()) check(result.base.name, result.base.content);
  for (const ResultCamera& camera : result.cameras) check(camera.file.name, camera.file.content);
}

/// True for the URDF that `init` writes for a base or a magnetometer without the robot's: a sensor on one link.
[[nodiscard]] bool is_sensor_alone(const Robot& robot) {
  if (robot.joints().size() != 1) return false;
  const Joint& joint = robot.joints().front();
  return joint.type == JointType::fixed &&
         (joint.name == "sensor_joint" || joint.name == "magnetometer_joint");
}

/// Reads whether the calibration converged, and the first reason against using it.
void read_report(const std::filesystem::path& report, ResultFolder& result) {
  if (!std::filesystem::exists(report)) return;
  result.report = {report.filename().string(), read_text_file(report)};
  try {
    const JsonValue file = JsonValue::parse(result.report.content);
    check_is_whole(report.parent_path(), file, result);
    if (!file.find("converged")) throw JsonError("does not say whether the result converged");
    result.converged = file.flag("converged");
    if (file.text_or("verdict", {}) != "do not use") return;
    const auto reasons = file.find("reasons") ? file.texts("reasons") : std::vector<std::string>();
    result.refusal = reasons.empty() ? "do not use" : reasons.front();
  } catch (const JsonError& error) {
    throw InputError(report.string() + ": " + error.what());
  }
}

}  // namespace
}  // namespace detail

ResultFolder read_result_folder(const std::filesystem::path& folder) {
  const std::filesystem::path path = detail::values_file(folder);
  ResultFolder result;
  result.values = {path.filename().string(), detail::read_text_file(path)};
  result.date = detail::date_in_name(path.stem().string());
  if (result.date.empty()) result.date = detail::date_of_file(path);
  std::filesystem::path urdf_path;
  const detail::YamlNode values = detail::yaml_map(result.values.content, path.string());
  for (std::size_t i = 0; i < values.keys.size(); ++i) {
    const detail::YamlNode& item = values.items[i];
    if (!values.keys[i].is_scalar() || !detail::config_text(item)) continue;
    const std::string key = values.keys[i].text;
    if (const auto value = detail::config_number(item)) {
      result.parameters[key] = *value;
    } else if (key == "urdf") {
      result.urdf = detail::named_file(folder, path.string(), item);
      urdf_path = folder / item.text;
    } else if (key == "base") {
      result.base = detail::named_file(folder, path.string(), item);
      result.base_values = detail::number_entries(
          detail::yaml_map(result.base.content, (folder / item.text).string()));
    } else if (auto camera = detail::camera_key(key)) {
      camera->file = detail::named_file(folder, path.string(), item);
      camera->name = detail::camera_name(camera->file.content, folder / item.text);
      result.cameras.push_back(*camera);
    }
  }
  if (result.urdf.name.empty())
    throw InputError(path.string() + ": does not name a URDF; it needs a line 'urdf: FILE'");
  const Robot robot = parse_urdf(result.urdf.content, urdf_path.string());
  result.has_robot = !detail::is_sensor_alone(robot);
  detail::read_report(folder / "report.json", result);
  return result;
}

}  // namespace kinecal
