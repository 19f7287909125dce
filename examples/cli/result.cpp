// SPDX-License-Identifier: Apache-2.0
#include "result.hpp"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "kinecal/config/doubts/rising.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/json/json_value.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/yaml/yaml_node.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/tools/install/result_folder.hpp"
#include "output.hpp"

namespace kinecal::cli {
namespace {

using detail::JsonError;
using detail::JsonValue;

constexpr const char* kAgain = "; calibrate again with this version";

void read_covariance(const JsonValue& report, Result& result) {
  const JsonValue covariance = report.at("covariance");
  result.parameters = covariance.texts("parameters");
  for (const JsonValue& row : covariance.list("lower")) {
    result.covariance.push_back(row.as_numbers());
    if (result.covariance.back().size() != result.covariance.size()) {
      throw JsonError("'covariance.lower' is not a lower triangle");
    }
  }
  if (result.covariance.size() != result.parameters.size()) {
    throw JsonError(fmt::format("it has {} rows of a covariance of {} parameters",
                                result.covariance.size(), result.parameters.size()));
  }
  for (const JsonValue& combination : covariance.list("undetermined")) {
    auto& of = result.undetermined.emplace_back();
    for (const auto& [name, factor] : combination.fields())
      of.emplace_back(name, factor.as_number());
  }
}

void read_noise(const JsonValue& report, Result& result) {
  for (const JsonValue& entry : report.list("noise")) {
    BlockNoise noise;
    noise.block = entry.text("name");
    noise.unit = entry.text("unit");
    noise.features = static_cast<int>(entry.integer("features"));
    noise.components = static_cast<int>(entry.integer("components"));
    noise.freedom = entry.number("freedom");
    noise.sigma = entry.number("sigma");
    if (entry.find("held_out")) result.fitted[noise.block].held_out = entry.number("held_out");
    result.noise.push_back(noise);
  }
  for (const JsonValue& entry : report.list("error_blocks")) {
    const std::string name = entry.text("name");
    for (const BlockNoise& noise : result.noise) {
      if (noise.block != name) continue;
      result.fitted[name].distance =
          std::sqrt(static_cast<double>(noise.components)) * entry.at("after").number("rms");
    }
  }
}

void read_poses(const JsonValue& report, Result& result) {
  const JsonValue poses = report.at("poses");
  result.poses.joints = poses.texts("joints");
  for (const JsonValue& row : poses.list("positions")) {
    result.poses.positions.push_back(row.as_numbers());
    if (result.poses.positions.back().size() != result.poses.joints.size()) {
      throw JsonError("it has a pose with a wrong number of joints");
    }
  }
  const auto pose = report.find("pose");
  if (!pose) return;
  const auto frame = [&](const char* name, const char* link) {
    FrameOnRobot of{pose->text(link)};
    if (pose->text(name) != of.link) of.frame = pose->text(name);
    return of;
  };
  result.pose = {frame("frame", "link"), frame("in", "in_link"), pose->number("position")};
}

/// Reads the deviations.  The values of report.json must be those of calibration.yaml.
void read_parameters(const JsonValue& report, const std::string& values_file, Result& result) {
  for (const JsonValue& entry : report.list("parameters")) {
    const std::string name = entry.text("name");
    const double value = entry.number("value");
    result.deviations[name] =
        entry.find("sigma") ? entry.number("sigma") : std::numeric_limits<double>::infinity();
    result.units[name] = entry.text("unit");
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
void read_images(const JsonValue& report, Config& config) {
  const JsonValue images = report.at("images");
  for (StepConfig& step : config.steps) {
    for (ModelConfig& model : step.models) {
      if (!images.find(model.name)) continue;
      model.image = images.text(model.name) == "raw" ? ImageKind::raw : ImageKind::rectified;
    }
  }
}

/// @throws JsonError  if something is missing or is not what it should be
void read_report(const std::string& values_file, Result& result) {
  const JsonValue report = JsonValue::parse(detail::read_text_file(result.report));
  result.verdict = report.text("verdict");
  if (result.verdict == to_string(Grade::do_not_use)) {
    throw InputError(result.report + ": this result was judged 'do not use'; calibrate again");
  }
  read_parameters(report, values_file, result);
  read_covariance(report, result);
  read_noise(report, result);
  read_poses(report, result);
  read_images(report, result.config);
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
  result.urdf_text = read_urdf_text(result.urdf);
  result.robot = parse_urdf(result.urdf_text, result.urdf);
  Diagnostics diagnostics;
  result.config = read_config(config, diagnostics);
  diagnostics.throw_if_errors();
  try {
    read_report((std::filesystem::path(folder) / files.values.name).string(), result);
  } catch (const JsonError& error) {
    throw InputError(result.report + ": " + error.what() + kAgain);
  }
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
