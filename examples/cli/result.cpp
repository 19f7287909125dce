// SPDX-License-Identifier: Apache-2.0
#include "result.hpp"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "kinecal/config/doubts/rising.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/yaml/yaml_node.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/tools/install/result_folder.hpp"
#include "output.hpp"

namespace kinecal::cli {
namespace {

using detail::YamlNode;

constexpr const char* kAgain = "; calibrate again with this version";

/// The content of report.json: what is missing or is not what it should be is an error with its line.
class Report {
 public:
  explicit Report(std::string path)
      : path_(std::move(path)),
        documents_(detail::parse_yaml(detail::read_text_file(path_), path_)) {
    if (documents_.size() != 1 || !documents_[0].is_map()) fail(0, "is not a report");
  }

  [[noreturn]] void fail(int line, const std::string& what) const {
    throw InputError(SourceLocation{path_, line}.str() + ": " + what + kAgain);
  }
  [[nodiscard]] const YamlNode& root() const { return documents_[0]; }
  [[nodiscard]] const YamlNode& at(const YamlNode& map, const char* key) const {
    const YamlNode* found = map.find(key);
    if (found == nullptr) fail(map.line, fmt::format("has no '{}'", key));
    return *found;
  }
  [[nodiscard]] const YamlNode& list(const YamlNode& map, const char* key) const {
    const YamlNode& found = at(map, key);
    if (!found.is_list()) fail(found.line, fmt::format("'{}' is not a list", key));
    return found;
  }
  [[nodiscard]] double number(const YamlNode& node) const {
    const auto value = node.is_scalar() ? number_from_yaml(node.text) : std::nullopt;
    if (!value || !std::isfinite(*value)) {
      fail(node.line, fmt::format("'{}' is not a number", node.text));
    }
    return *value;
  }
  [[nodiscard]] std::vector<double> numbers(const YamlNode& list) const {
    std::vector<double> all;
    for (const YamlNode& item : list.items) all.push_back(number(item));
    return all;
  }
  [[nodiscard]] static std::vector<std::string> names(const YamlNode& list) {
    std::vector<std::string> all;
    for (const YamlNode& item : list.items) all.push_back(item.text);
    return all;
  }

 private:
  std::string path_;
  std::vector<YamlNode> documents_;
};

/// null, as JSON writes it
[[nodiscard]] bool is_null(const YamlNode& node) {
  return node.is_null() || (node.is_scalar() && node.text == "null");
}

void read_covariance(const Report& report, Result& result) {
  const YamlNode& covariance = report.at(report.root(), "covariance");
  if (!covariance.is_map()) report.fail(covariance.line, "has no covariance");
  result.parameters = Report::names(report.list(covariance, "parameters"));
  const YamlNode& lower = report.list(covariance, "lower");
  for (const YamlNode& row : lower.items) {
    result.covariance.push_back(report.numbers(row));
    if (result.covariance.back().size() != result.covariance.size()) {
      report.fail(row.line, "'lower' is not a lower triangle");
    }
  }
  if (result.covariance.size() != result.parameters.size()) {
    report.fail(lower.line, fmt::format("has {} rows of a covariance of {} parameters",
                                        result.covariance.size(), result.parameters.size()));
  }
  for (const YamlNode& combination : report.list(covariance, "undetermined").items) {
    auto& of = result.undetermined.emplace_back();
    for (std::size_t i = 0; i < combination.keys.size(); ++i) {
      of.emplace_back(combination.keys[i].text, report.number(combination.items[i]));
    }
  }
}

void read_noise(const Report& report, Result& result) {
  for (const YamlNode& entry : report.list(report.root(), "noise").items) {
    BlockNoise noise;
    noise.block = report.at(entry, "name").text;
    noise.unit = report.at(entry, "unit").text;
    noise.features = static_cast<int>(report.number(report.at(entry, "features")));
    noise.components = static_cast<int>(report.number(report.at(entry, "components")));
    noise.freedom = report.number(report.at(entry, "freedom"));
    noise.sigma = report.number(report.at(entry, "sigma"));
    const YamlNode& held_out = report.at(entry, "held_out");
    if (!is_null(held_out)) result.fitted[noise.block].held_out = report.number(held_out);
    result.noise.push_back(noise);
  }
  for (const YamlNode& entry : report.list(report.root(), "error_blocks").items) {
    const std::string name = report.at(entry, "name").text;
    for (const BlockNoise& noise : result.noise) {
      if (noise.block != name) continue;
      result.fitted[name].distance = std::sqrt(static_cast<double>(noise.components)) *
                                     report.number(report.at(report.at(entry, "after"), "rms"));
    }
  }
}

void read_poses(const Report& report, Result& result) {
  const YamlNode& poses = report.at(report.root(), "poses");
  result.poses.joints = Report::names(report.list(poses, "joints"));
  for (const YamlNode& row : report.list(poses, "positions").items) {
    result.poses.positions.push_back(report.numbers(row));
    if (row.items.size() != result.poses.joints.size()) {
      report.fail(row.line, "has a pose with a wrong number of joints");
    }
  }
  const YamlNode& pose = report.at(report.root(), "pose");
  if (is_null(pose)) return;
  const auto frame = [&](const char* name, const char* link) {
    FrameOnRobot of{report.at(pose, link).text};
    if (report.at(pose, name).text != of.link) of.frame = report.at(pose, name).text;
    return of;
  };
  result.pose = {frame("frame", "link"), frame("in", "in_link"),
                 report.number(report.at(pose, "position"))};
}

/// Reads the deviations.  The values of report.json must be those of calibration.yaml.
void read_parameters(const Report& report, const std::string& values_file, Result& result) {
  for (const YamlNode& entry : report.list(report.root(), "parameters").items) {
    const std::string name = report.at(entry, "name").text;
    const double value = report.number(report.at(entry, "value"));
    const YamlNode& sigma = report.at(entry, "sigma");
    result.deviations[name] =
        is_null(sigma) ? std::numeric_limits<double>::infinity() : report.number(sigma);
    result.units[name] = report.at(entry, "unit").text;
    const auto found = result.values.find(name);
    constexpr double kSame = 1e-12;
    if (found != result.values.end() &&
        std::abs(found->second - value) <= kSame * (1.0 + std::abs(value))) {
      continue;
    }
    throw InputError(fmt::format(
        "{}: '{}' is {} there and {} in report.json; one of them was changed or is of another run, "
        "so calibrate again",
        values_file, name,
        found == result.values.end() ? "missing" : fmt::format("{}", found->second), value));
  }
}

/// Reads what the images of cameras were taken for.
void read_images(const Report& report, Config& config) {
  const YamlNode& images = report.at(report.root(), "images");
  for (StepConfig& step : config.steps) {
    for (ModelConfig& model : step.models) {
      if (const YamlNode* image = images.find(model.name)) {
        model.image = image->text == "raw" ? ImageKind::raw : ImageKind::rectified;
      }
    }
  }
}

/// A file of the result.
/// @throws InputError  if an older version did not write it, or it was removed
std::string needed_file(const std::string& folder, const char* name) {
  const std::filesystem::path path = std::filesystem::path(folder) / name;
  if (std::filesystem::exists(path)) return path.string();
  throw InputError(folder + ": has no " + name +
                   ", so it cannot be checked; an older version wrote it, " +
                   "or the file was removed" + kAgain);
}

}  // namespace

Result read_result(const std::string& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw InputError(folder +
                     (std::filesystem::exists(folder) ? ": is not a folder" : ": does not exist") +
                     "; give the folder that 'kinecal calibrate --output' wrote");
  }
  const ResultFolder files = read_result_folder(folder);
  Result result;
  result.folder = folder;
  result.values = files.parameters;
  result.report = needed_file(folder, "report.json");
  result.urdf = needed_file(folder, kOriginalUrdf);
  const std::string config = needed_file(folder, kConfigCopy);
  const Report report(result.report);
  result.verdict = report.at(report.root(), "verdict").text;
  if (result.verdict == to_string(Grade::do_not_use)) {
    throw InputError(result.report + ": this result was judged 'do not use'; calibrate again");
  }
  read_parameters(report, (std::filesystem::path(folder) / files.values.name).string(), result);
  read_covariance(report, result);
  read_noise(report, result);
  read_poses(report, result);
  result.urdf_text = read_urdf_text(result.urdf);
  result.robot = parse_urdf(result.urdf_text, result.urdf);
  Diagnostics diagnostics;
  result.config = read_config(config, diagnostics);
  diagnostics.throw_if_errors();
  read_images(report, result.config);
  result.added_rising = rising_of(files.urdf.content, files.urdf.name);
  for (const auto& [joint, rising] : rising_of(result.urdf_text, result.urdf)) {
    result.added_rising[joint] -= rising;
  }
  std::erase_if(result.added_rising, [](const auto& of) { return of.second == 0.0; });
  return result;
}

std::vector<double> Result::values_of(const ParameterTable& table) const {
  std::vector<double> all;
  for (const Parameter& parameter : table) {
    const auto found = values.find(parameter.name);
    all.push_back(found == values.end() ? 0.0 : found->second);
  }
  return all;
}

CalibratedState Result::state(const ParameterTable& table) const {
  CalibratedState state;
  const auto index = [&](const std::string& name) {
    const int found = table.find(name);
    if (found >= 0) return found;
    throw InputError(report + ": '" + name + "' was calibrated, but " + config.place.file +
                     " does not have it; one of them was changed, so calibrate again");
  };
  state.values = values_of(table);
  for (const std::string& name : parameters) state.parameters.push_back(index(name));
  const auto n = static_cast<Eigen::Index>(parameters.size());
  Eigen::MatrixXd full(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      full(i, j) = full(j, i) =
          covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    }
  }
  state.covariance = full;
  for (const auto& combination : undetermined) {
    Combination& of = state.undetermined.emplace_back();
    for (const auto& [name, factor] : combination) of.emplace_back(index(name), factor);
  }
  state.noise = noise;
  return state;
}

std::vector<Sample> Result::pose_samples() const {
  std::vector<Sample> all;
  for (const std::vector<double>& positions : poses.positions) {
    Sample sample;
    sample.joint_names = poses.joints;
    sample.joint_positions = positions;
    all.push_back(std::move(sample));
  }
  return all;
}

}  // namespace kinecal::cli
