// The parameters of the text report.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "kinecal/report/findings.hpp"
#include "kinecal/report/text.hpp"

namespace kinecal::detail {

/// True for a parameter of a frame whose pose nobody knew: it was searched for.
[[nodiscard]] inline bool was_unknown(const Findings& findings, const Parameter& parameter) {
  for (const StepResult& step : findings.result.steps) {
    for (const std::string& frame : step.starts.frames) {
      if (is_frame_parameter(parameter.name, frame)) return true;
    }
  }
  return false;
}

/// True of cameras alone: each sample has a pose of its own.
[[nodiscard]] inline bool are_cameras_alone(const Findings& findings) {
  constexpr double kOwn = 5.0;  // residuals of a sample, of the six of a pose
  if (findings.assessments.empty()) return false;
  const Assessment& last = findings.assessments.back();
  return last.used > kOwn * static_cast<double>(last.samples);
}

/// True if a parameter is shown among the numbers of its camera: nobody knew these of cameras alone, so that a change in
/// per cent says nothing.
[[nodiscard]] inline bool is_of_camera_alone(const Findings& findings, const Parameter& parameter) {
  if (!are_cameras_alone(findings)) return false;
  for (const ProjectionMap& map : findings.assessments.back().maps) {
    for (const CameraNumber& number : map.numbers) {
      if (parameter.name == parameter_name(map.sensor, number.name)) return true;
    }
  }
  return false;
}

/// The parameters that were searched for, or the others.
[[nodiscard]] inline std::string parameter_rows(const Findings& findings, bool unknown,
                                                Figures figures) {
  TextTable::Row header = {"parameter", "before", "after", "+-", "unit", ""};
  if (figures == Figures::raw)
    header = {"parameter", "before", "after", "+-", "unit", "value", "from", ""};
  TextTable table(header);
  int rows = 0;
  for (const int i : findings.result.calibrated) {
    const Parameter& parameter = findings.result.table[i];
    if (was_unknown(findings, parameter) != unknown) continue;
    if (is_of_camera_alone(findings, parameter)) continue;
    ++rows;
    const auto deviation = findings.deviation(i);
    const auto [after, unit] = for_people(parameter.value, parameter.unit);
    const std::string known =
        deviation && std::isfinite(*deviation) ? for_people(*deviation, parameter.unit).first : "-";
    TextTable::Row row = {parameter.name,
                          unknown ? "-" : for_people(parameter.initial, parameter.unit).first,
                          after, known, unit};
    if (figures == Figures::raw) {
      row.push_back(fmt::format("{:.8g}", parameter.value));
      row.push_back(fmt::format("{:.8g}", parameter.initial));
    }
    row.push_back(deviation ? note_on(parameter, *deviation) : "at its bound");
    table.add(std::move(row));
  }
  for (const int i : unknown ? std::vector<int>() : findings.held) {
    const Parameter& parameter = findings.result.table[i];
    const auto [value, unit] = for_people(parameter.value, parameter.unit);
    TextTable::Row row = {parameter.name, value, value, "-", unit};
    if (figures == Figures::raw) {
      row.insert(row.end(), 2, fmt::format("{:.8g}", parameter.value));
    }
    row.push_back("held");
    table.add(std::move(row));
    ++rows;
  }
  return rows == 0 ? "" : table.str();
}

[[nodiscard]] inline std::string parameters_text(const Findings& findings, Figures figures) {
  std::string text;
  const std::string changed = parameter_rows(findings, false, figures);
  const std::string found = parameter_rows(findings, true, figures);
  const ParameterTable& table = findings.result.table;
  const auto is_turn = [&](int i) {
    const std::string owner = table[i].name.substr(0, table[i].name.rfind('_'));
    return table[i].unit == "rad" && is_frame_parameter(table[i].name, owner) &&
           table.find(parameter_name(owner, "x")) >= 0;
  };
  const std::vector<int>& rows = findings.result.calibrated;
  const bool turns = std::any_of(rows.begin(), rows.end(), is_turn);
  const std::string about = "; +- is one standard deviation" +
                            (turns ? "; " + std::string(kAxesOfFrames) : std::string()) + "\n";
  if (!changed.empty()) text += "Parameters" + about + changed;
  if (!found.empty()) {
    text += (text.empty() ? "" : "\n") + std::string("Poses that were not known") +
            (text.empty() ? about : "\n") + found;
  }
  for (const StepResult& step : findings.result.steps) {
    if (step.starts.searched()) text += "  " + to_string(step.starts) + "\n";
  }
  if (findings.assessments.empty()) return text;
  const Assessment& step = findings.assessments.back();
  if (!step.compared.empty()) text += "\n";
  for (const PoseUncertainty& pose : step.compared) {
    text +=
        fmt::format("Pose of '{}' in '{}': +- {}, {}; at the worst of these samples {}, {}\n",
                    pose.frame, pose.in, reading(pose.position, "m"), reading(pose.rotation, "rad"),
                    reading(pose.worst_position, "m"), reading(pose.worst_rotation, "rad"));
    if (pose.elsewhere > 0.0) {
      text += fmt::format("  over the limits of the joints: {} (median)\n",
                          reading(pose.elsewhere, "m"));
    }
  }
  for (const PoseUncertainty& pose : step.between) {
    text += pose.determined
                ? fmt::format("Pose of '{}' in '{}': +- {}, {}\n", pose.frame, pose.in,
                              reading(pose.position, "m"), reading(pose.rotation, "rad"))
                : fmt::format("Pose of '{}' in '{}': not determined\n", pose.frame, pose.in);
  }
  return text;
}

}  // namespace kinecal::detail
