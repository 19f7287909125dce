// Reads report.json into a StoredResult: values, covariance, noise, poses, the verdict.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/files/json/json_value.hpp"
#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/report/json.hpp"
#include "kinecal/tools/install/stored_result.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal::detail {

inline void read_covariance(const JsonValue& report, StoredResult& result) {
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
[[nodiscard]] inline std::int64_t format_of(const JsonValue& report) {
  const std::int64_t format = report.find("format") ? report.integer("format") : 1;
  if (format < 1 || format > kReportFormat) {
    throw JsonError(fmt::format("it has format {}, and this version of kinecal reads up to {}",
                                format, kReportFormat));
  }
  return format;
}

inline void read_noise(const JsonValue& report, std::int64_t format, StoredResult& result) {
  for (const JsonValue& entry : report.list("noise")) {
    BlockNoise noise;
    noise.block = entry.text("name");
    noise.unit = entry.text("unit");
    noise.features = entry.integer("features");
    noise.components = static_cast<int>(entry.integer("components"));
    noise.freedom = entry.number("freedom");
    noise.sigma = entry.number("sigma");
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
[[nodiscard]] inline Pose<double> measured_pose(const JsonValue& value) {
  const std::vector<double> numbers = value.as_numbers();
  const PoseForm form;
  if (!form.has_size(numbers.size())) throw JsonError("it has a measured pose without 7 numbers");
  const NumberedPose read = pose_from_numbers(form, numbers);
  if (!read.wrong.empty()) throw JsonError("it has a measured pose that is wrong: " + read.wrong);
  return read.pose;
}

inline void read_poses(const JsonValue& report, StoredResult& result) {
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
inline void read_parameters(const JsonValue& report, const std::string& values_file,
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
inline void read_images(const JsonValue& report, Config& config) {
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
inline void read_cameras(const JsonValue& report, StoredResult& result) {
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
inline void read_calibration(const std::string& content, const std::string& values_file,
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
}

}  // namespace kinecal::detail
