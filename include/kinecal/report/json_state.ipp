// What verify and compare need of a report: the covariance, what was not determined, the poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>

#include "kinecal/report/json.hpp"
#include "kinecal/trust/drift.hpp"

namespace kinecal {

namespace detail {

/// The parameters of all steps with their covariance; those of an earlier step that a later one frees
/// again are those of the later one.
[[nodiscard]] inline CalibratedState state_of_steps(const std::vector<Assessment>& assessments) {
  CalibratedState state;
  std::vector<std::pair<const Assessment*, Eigen::Index>> columns;
  for (auto step = assessments.rbegin(); step != assessments.rend(); ++step) {
    CalibratedState of_step = calibrated_state(*step, {});
    for (std::size_t c = 0; c < of_step.parameters.size(); ++c) {
      const int p = of_step.parameters[c];
      const auto& known = state.parameters;
      if (std::find(known.begin(), known.end(), p) != known.end()) continue;
      state.parameters.push_back(p);
      columns.emplace_back(&*step, static_cast<Eigen::Index>(c));
    }
    if (step == assessments.rbegin()) state.undetermined = std::move(of_step.undetermined);
  }
  const Eigen::Index n = std::ssize(columns);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto& row = columns[static_cast<std::size_t>(i)];
      const auto& column = columns[static_cast<std::size_t>(j)];
      if (row.first != column.first) continue;
      covariance(i, j) = row.first->uncertainty.covariance(row.second, column.second);
    }
  }
  state.covariance = covariance;
  return state;
}

/// "{"elbow": 1, "wrist": -0.5}"
[[nodiscard]] inline std::string json(const Combination& combination, const ParameterTable& table) {
  std::string factors;
  for (const auto& [parameter, factor] : combination) {
    factors += fmt::format("{}{}: {}", factors.empty() ? "" : ", ",
                           json_string(table[parameter].name), json_number(factor));
  }
  return "{" + factors + "}";
}

/// "[\n    a,\n    b\n  ]"
template <class Items, class Write>
[[nodiscard]] std::string json_list(const Items& items, Write&& write) {
  std::string list;
  for (const auto& item : items) list += (list.empty() ? "\n    " : ",\n    ") + write(item);
  return list.empty() ? "[]" : "[" + list + "\n  ]";
}

/// "[a, b]"
template <class Items, class Write>
[[nodiscard]] std::string json_row(const Items& items, Write&& write) {
  std::string row;
  for (const auto& item : items) row += (row.empty() ? "" : ", ") + write(item);
  return "[" + row + "]";
}

/// Parameters, the lower triangle of their covariance row by row, and combinations that nothing
/// determines, along which it is zero.
[[nodiscard]] inline std::string json_covariance(const Findings& findings) {
  if (findings.assessments.empty()) return "null";
  const ParameterTable& table = findings.result.table;
  const CalibratedState state = state_of_steps(findings.assessments);
  std::vector<std::vector<double>> rows;
  for (Eigen::Index i = 0; i < state.covariance.rows(); ++i) {
    rows.emplace_back();
    for (Eigen::Index j = 0; j <= i; ++j) rows.back().push_back(state.covariance(i, j));
  }
  const auto name = [&](int p) { return json_string(table[p].name); };
  const auto row = [](const auto& numbers) { return json_row(numbers, json_number); };
  const auto combination = [&](const Combination& of) { return json(of, table); };
  return fmt::format("{{\n  \"parameters\": {},\n  \"lower\": {},\n  \"undetermined\": {}\n  }}",
                     json_row(state.parameters, name), json_list(rows, row),
                     json_list(state.undetermined, combination));
}

/// Joint positions, to six digits.
[[nodiscard]] inline std::string json(const RecordedPoses& poses) {
  const auto number = [](double value) { return fmt::format("{:.6g}", value); };
  const auto row = [&](const auto& numbers) { return json_row(numbers, number); };
  return fmt::format("{{\n  \"joints\": {},\n  \"positions\": {}\n  }}",
                     json_row(poses.joints, json_string), json_list(poses.positions, row));
}

}  // namespace detail

}  // namespace kinecal
