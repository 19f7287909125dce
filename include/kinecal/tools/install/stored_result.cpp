// Definitions of stored_result.hpp; stored_result.cpp reads its report.json.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/install/stored_result.hpp"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "kinecal/config/doubts/rising.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/json/json_value.hpp"
#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/report/json.hpp"
#include "kinecal/tools/install/result_folder.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal {

namespace detail {
namespace {

// Reads report.json into a StoredResult: values, covariance, noise, poses, the verdict.

void read_covariance(const JsonValue& report, StoredResult& result) {
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

/// 1 where the report does not say it.
[[nodiscard]] std::int64_t format_of(const JsonValue& report) {
  const std::int64_t format = report.find("format") ? report.integer("format") : 1;
  if (format < 1 || format > kReportFormat) {
    throw JsonError(fmt::format("it has format {}, and this version of kinecal reads up to {}",
                                format, kReportFormat));
  }
  return format;
}

void read_noise(const JsonValue& report, std::int64_t format, StoredResult& result) {
  for (const JsonValue& entry : report.list("noise")) {
    BlockNoise noise;
    noise.block = entry.text("name");
    noise.unit = entry.text("unit");
    noise.features = entry.integer("features");
    noise.components = static_cast<int>(entry.integer("components"));
    noise.freedom = entry.number("freedom");
    noise.sigma = entry.number("sigma");
    if (entry.find("robust_sigma")) noise.robust = entry.number("robust_sigma");
    if (entry.find("own_sigma")) {
      noise.own = entry.number("own_sigma");
      noise.own_freedom = entry.number("own_freedom");
    }
    if (entry.find("held_out")) result.fitted[noise.block].held_out = entry.number("held_out");
    result.noise.push_back(noise);
  }
  const auto common = report.find("common_noise");
  result.knows_common = common.has_value();
  if (common) {
    const auto number = [&](const char* key) {
      return common->find(key) ? common->number(key) : 0.0;
    };
    result.common = {common->flag("separable"), common->number("repeats"),
                     number("shifts"),          number("turns"),
                     common->number("freedom"), common->number("effect")};
  }
  const bool of_components = format == 1;
  for (const JsonValue& entry : report.list("error_blocks")) {
    const std::string name = entry.text("name");
    for (const BlockNoise& noise : result.noise) {
      if (noise.block != name) continue;
      const double rms = entry.at("after").number("rms");
      result.fitted[name].distance =
          of_components ? std::sqrt(static_cast<double>(noise.components)) * rms : rms;
    }
  }
}

/// The measured pose of a floating joint: x y z qx qy qz qw.
[[nodiscard]] Pose<double> measured_pose(const JsonValue& value) {
  const std::vector<double> numbers = value.as_numbers();
  const PoseForm form;
  if (!form.has_size(numbers.size())) throw JsonError("it has a measured pose without 7 numbers");
  const NumberedPose read = pose_from_numbers(form, numbers);
  if (!read.wrong.empty()) throw JsonError("it has a measured pose that is wrong: " + read.wrong);
  return read.pose;
}

void read_poses(const JsonValue& report, StoredResult& result) {
  const JsonValue poses = report.at("poses");
  result.poses.joints = poses.texts("joints");
  for (const JsonValue& row : poses.list("positions")) {
    result.poses.positions.push_back(row.as_numbers());
    if (result.poses.positions.back().size() != result.poses.joints.size()) {
      throw JsonError("it has a pose with a wrong number of joints");
    }
  }
  if (poses.find("floating")) {
    result.poses.floating = poses.texts("floating");
    for (const JsonValue& row : poses.list("measured")) {
      std::vector<Pose<double>>& measured = result.poses.measured.emplace_back();
      for (const JsonValue& numbers : row.as_list()) measured.push_back(measured_pose(numbers));
      if (measured.size() != result.poses.floating.size()) {
        throw JsonError("it has a pose with a wrong number of floating joints");
      }
    }
    if (result.poses.measured.size() != result.poses.positions.size()) {
      throw JsonError("it has not as many measured poses as joint positions");
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
void read_parameters(const JsonValue& report, const std::string& values_file,
                     StoredResult& result) {
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

/// Reads what the images of cameras were taken for, and their lenses.
void read_images(const JsonValue& report, Config& config) {
  const JsonValue images = report.at("images");
  const auto lenses = report.find("lenses");  // older reports have none
  for (StepConfig& step : config.steps) {
    for (ModelConfig& model : step.models) {
      if (lenses && lenses->find(model.name)) model.lens = lenses->text(model.name);
      if (!images.find(model.name)) continue;
      model.image = images.text(model.name) == "raw" ? ImageKind::raw : ImageKind::rectified;
    }
  }
}

/// Reads the numbers of cameras.
void read_cameras(const JsonValue& report, StoredResult& result) {
  if (!report.find("cameras")) return;  // an older report
  for (const JsonValue& camera : report.list("cameras")) {
    if (!camera.find("numbers")) continue;
    for (const ModelConfig& model : models_of(result.config)) {
      if (model.name != camera.text("sensor")) continue;
      for (const auto& [name, number] : camera.at("numbers").fields()) {
        result.camera_numbers[parameter_name(model.param_name, name)] = {
            number.number("value"), number.find("sigma") ? number.number("sigma")
                                                         : std::numeric_limits<double>::infinity()};
      }
    }
  }
}

/// Reads the rest of report.json.
/// @param values_file  path of calibration.yaml, for messages
/// @throws JsonError  if something is missing or is not what it should be
void read_calibration(const std::string& content, const std::string& values_file,
                      StoredResult& result) {
  const JsonValue report = JsonValue::parse(content);
  const std::int64_t format = format_of(report);
  result.verdict = report.text("verdict");
  if (result.verdict == to_string(Grade::do_not_use)) {
    throw InputError(result.report + ": this result was judged 'do not use'; calibrate again");
  }
  read_parameters(report, values_file, result);
  read_covariance(report, result);
  read_noise(report, format, result);
  read_poses(report, result);
  read_images(report, result.config);
  read_cameras(report, result);
  if (!report.find("inputs")) return;  // of a result that no program wrote
  for (const JsonValue& input : report.list("inputs")) {
    if (input.text("role") == "URDF") result.urdf_then = input.text("name");
  }
}

}  // namespace

inline constexpr const char* kAgain = "; calibrate again with this version";

/// A file of the result.
/// @throws InputError  if an older version did not write it, or it was removed
[[nodiscard]] inline std::string needed_file(const std::string& folder, const char* name) {
  const std::filesystem::path path = std::filesystem::path(folder) / name;
  if (std::filesystem::exists(path)) return path.string();
  throw InputError(folder + ": has no " + name +
                   ", so it cannot be checked; an older version wrote it, " +
                   "or the file was removed" + kAgain);
}

}  // namespace detail

StoredResult read_result(const std::string& folder) {
  if (!std::filesystem::is_directory(folder)) {
    throw InputError(folder +
                     (std::filesystem::exists(folder) ? ": is not a folder" : ": does not exist") +
                     "; give the folder that 'kinecal calibrate --output' wrote");
  }
  const ResultFolder files = read_result_folder(folder);
  StoredResult result;
  result.folder = folder;
  result.values = files.parameters;
  result.report = detail::needed_file(folder, "report.json");
  result.urdf = detail::needed_file(folder, kOriginalUrdf);
  const std::string config = detail::needed_file(folder, kConfigCopy);
  result.urdf_text = read_urdf_text(result.urdf);
  result.robot = parse_urdf(result.urdf_text, result.urdf);
  Diagnostics diagnostics;
  result.config = read_config(config, diagnostics);
  diagnostics.throw_if_errors();
  try {
    detail::read_calibration(files.report.content,
                             (std::filesystem::path(folder) / files.values.name).string(), result);
  } catch (const detail::JsonError& error) {
    throw InputError(result.report + ": " + error.what() + detail::kAgain);
  }
  for (const auto read : {&rising_of, &ros2_control_offsets}) {
    for (const auto& [joint, after] : read(files.urdf.content, files.urdf.name)) {
      result.added_offsets[joint] += after;
    }
    for (const auto& [joint, before] : read(result.urdf_text, result.urdf)) {
      result.added_offsets[joint] -= before;
    }
  }
  std::erase_if(result.added_offsets, [](const auto& of) { return of.second == 0.0; });
  return result;
}

std::vector<double> StoredResult::values_of(const ParameterTable& table) const {
  std::vector<double> all;
  for (const Parameter& parameter : table) {
    const auto found = values.find(parameter.name);
    all.push_back(found == values.end() ? 0.0 : found->second);
  }
  return all;
}

CalibratedState StoredResult::state(const ParameterTable& table) const {
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
  state.common = common;
  return state;
}

std::vector<Sample> StoredResult::pose_samples() const {
  std::vector<Sample> all;
  for (std::size_t i = 0; i < poses.positions.size(); ++i) {
    const std::vector<double>& positions = poses.positions[i];
    Sample sample;
    for (std::size_t j = 0; j < poses.floating.size(); ++j) {
      sample.poses[poses.floating[j]] = poses.measured[i][j];
    }
    sample.joint_names = poses.joints;
    sample.joint_positions = positions;
    all.push_back(std::move(sample));
  }
  return all;
}

}  // namespace kinecal
