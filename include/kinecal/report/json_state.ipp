// The parts of a report for verify and compare: covariance, undetermined combinations, poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "kinecal/files/json/json_text.hpp"
#include "kinecal/report/findings.hpp"
#include "kinecal/trust/verify/drift.hpp"

namespace kinecal {

namespace detail {

/// The parameters of all steps with their covariance; if several steps free a parameter, the last
/// one counts.
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

/// {"elbow": 1, "wrist": -0.5}
[[nodiscard]] inline Json json(const Combination& combination, const ParameterTable& table) {
  Json factors = Json::object();
  for (const auto& [parameter, factor] : combination) factors[table[parameter].name] = factor;
  return factors;
}

template <class Items, class Write>
[[nodiscard]] Json json_list(const Items& items, Write&& write) {
  Json list = Json::array();
  for (const auto& item : items) list.push_back(write(item));
  return list;
}

/// Parameters, the lower triangle of their covariance row by row, and combinations that nothing
/// determines, along which it is zero.
[[nodiscard]] inline Json json_covariance(const Findings& findings) {
  if (findings.assessments.empty()) return nullptr;
  const ParameterTable& table = findings.result.table;
  const CalibratedState state = state_of_steps(findings.assessments);
  Json lower = Json::array();
  for (Eigen::Index i = 0; i < state.covariance.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j <= i; ++j) row.push_back(state.covariance(i, j));
    lower.push_back(std::move(row));
  }
  const auto name = [&](int p) { return table[p].name; };
  const auto combination = [&](const Combination& of) { return json(of, table); };
  return {{"parameters", json_list(state.parameters, name)},
          {"lower", std::move(lower)},
          {"undetermined", json_list(state.undetermined, combination)}};
}

/// Joint positions and measured poses (x y z qx qy qz qw), to six digits.
[[nodiscard]] inline Json json(const RecordedPoses& poses) {
  const auto number = [](double value) {
    return std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr);
  };
  const auto row = [&](const auto& numbers) { return json_list(numbers, number); };
  Json all = {{"joints", poses.joints}, {"positions", json_list(poses.positions, row)}};
  if (poses.floating.empty()) return all;
  const auto of_pose = [&](const Pose<double>& pose) {
    const Eigen::Vector4d q = quaternion(pose.rotation).normalized();
    const auto& t = pose.translation;
    return row(std::vector<double>{t.x(), t.y(), t.z(), q(0), q(1), q(2), q(3)});
  };
  all["floating"] = poses.floating;
  all["measured"] =
      json_list(poses.measured, [&](const auto& of) { return json_list(of, of_pose); });
  return all;
}

}  // namespace detail

}  // namespace kinecal
