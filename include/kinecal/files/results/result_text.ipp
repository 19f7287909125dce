// The names of a result's files, and the values in calibration.yaml.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/parameters/joint_models/joint_models.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal::detail {

/// "depth_camera.yaml"; with a date "depth_<date>.yaml", without the name "camera".
[[nodiscard]] inline std::string camera_file(const char* kind, const std::string& camera,
                                             const std::string& date) {
  std::string name = camera;
  std::replace(name.begin(), name.end(), '/', '_');
  if (date.empty()) return fmt::format("{}_{}.yaml", kind, name);
  return fmt::format("{}_{}{}.yaml", kind, name == "camera" ? "" : name + "_", date);
}

/// "calibrated.urdf", or with a date "calibrated_<date>.urdf".
[[nodiscard]] inline std::string dated(const std::string& stem, const char* ending,
                                       const std::string& date) {
  return date.empty() ? fmt::format("{}{}", stem, ending)
                      : fmt::format("{}_{}{}", stem, date, ending);
}

/// "q_true = q + this * sin(q)" of a parameter of a joint model, and whether the URDF holds it; else empty.
[[nodiscard]] inline std::string formula_text(const Robot& robot, const std::string& name) {
  const std::optional<JointModelParameter> of = joint_model_parameter(robot, name);
  if (!of || of->model->formula(of->part).empty()) return {};
  if (fits_urdf(*of)) return "in <mimic> of the URDF";
  return fmt::format("q_true = q + this * {}", of->model->formula(of->part));
}

/// Lines `name: value` for the parameters that some step freed, and for those held at nonzero
/// values.  Standard deviations are comments, like the formulas of joint models.
[[nodiscard]] inline std::string values_yaml(const Robot& robot, const CalibrationResult& result,
                                             const std::map<int, double>& deviations) {
  std::string text;
  for (int i = 0; i < result.table.size(); ++i) {
    const auto& freed = result.calibrated;
    const bool calibrated = std::find(freed.begin(), freed.end(), i) != freed.end();
    if (!calibrated && result.table[i].value == 0.0) continue;
    text += fmt::format("{}: {}", name_to_yaml(result.table[i].name),
                        number_to_yaml(result.table[i].value));
    std::string comment;
    if (const auto deviation = deviations.find(i); deviation != deviations.end()) {
      comment = std::isfinite(deviation->second) ? fmt::format("+- {:.2g}", deviation->second)
                                                 : "not determined";
    }
    const std::string formula = formula_text(robot, result.table[i].name);
    if (!comment.empty() && !formula.empty()) comment += "; ";
    comment += formula;
    text += comment.empty() ? "\n" : "  # " + comment + "\n";
  }
  return text;
}

}  // namespace kinecal::detail
