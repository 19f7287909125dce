// SPDX-License-Identifier: Apache-2.0
#include "study_tables.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "kinecal/files/json/json_text.hpp"
#include "kinecal/report/charts/spread.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal::cli {
namespace {

// StudyTrial::nonlinearity up to which variances are taken as predicted.  It is that of all residuals: a
// parameter that hangs on a prior may still vary more (1.36 times at 0.047, of 170 calibrations), which
// beyond_chance() names.
constexpr double kLinear = 0.06;
constexpr int kForVariance = 2;  // the fewest trials that have a variance

std::vector<const StudyGroup*> of_robot(const StudyResult& result, int robot) {
  std::vector<const StudyGroup*> groups;
  for (const StudyGroup& group : result.groups) {
    if (group.robot == robot) groups.push_back(&group);
  }
  return groups;
}

int robots_of(const StudyResult& result) {
  int robots = 0;
  for (const StudyGroup& group : result.groups) robots = std::max(robots, group.robot + 1);
  return robots;
}

/// The groups of all robots with the most poses.
std::vector<const StudyGroup*> with_most(const StudyResult& result) {
  std::vector<const StudyGroup*> groups;
  for (int robot = 0; robot < robots_of(result); ++robot) {
    const auto all = of_robot(result, robot);
    if (!all.empty()) groups.push_back(all.front());
  }
  return groups;
}

std::string variance(double value) {
  return std::isfinite(value) ? fmt::format("{:.2e}", value) : "-";
}

std::string unit_of(const StudyInput& input, std::size_t p) {
  return input.calibration.table[input.setup.free[p]].unit;
}

/// A table of variances: one pair of columns for each group.
std::string variances(const StudyInput& input, const std::vector<const StudyGroup*>& groups,
                      const std::vector<std::string>& titles, bool ratio) {
  TextTable::Row header = {"parameter", "unit^2"};
  for (const std::string& title : titles) {
    header.push_back(title);
    header.push_back("predicted");
  }
  if (ratio) header.push_back("ratio");
  TextTable table(header, 2);
  const std::vector<std::string> names = free_names(input);
  for (std::size_t p = 0; p < names.size(); ++p) {
    TextTable::Row row = {names[p], unit_of(input, p)};
    for (const StudyGroup* group : groups) {
      row.push_back(variance(group->parameters[p].variance));
      row.push_back(variance(group->parameters[p].predicted));
    }
    if (ratio) {
      const ParameterSpread &most = groups.front()->parameters[p],
                            &least = groups.back()->parameters[p];
      row.push_back(most.variance > 0.0 && std::isfinite(most.predicted)
                        ? fmt::format("{:.1f}", least.variance / most.variance)
                        : "-");
    }
    table.add(row);
  }
  return table.str();
}

std::string table_one(const StudyInput& input, const StudyResult& result) {
  const auto groups = of_robot(result, 0);
  if (groups.empty() || groups.front()->trials < kForVariance) return "";
  std::vector<std::string> titles;
  for (const StudyGroup* group : groups) titles.push_back(fmt::format("{} poses", group->poses));
  const bool has_ratio = groups.size() > 1;
  std::string text = fmt::format(
      "Table I: variance of {} calibrations of robot 1, and the one that the covariance "
      "predicts\n",
      groups.front()->trials);
  text += variances(input, groups, titles, has_ratio);
  if (!has_ratio) return text;
  const int most = groups.front()->poses, least = groups.back()->poses;
  text += fmt::format("Median of the ratios {}:{}: {:.1f}; independent poses give {:.1f}", least,
                      most, variance_ratio(result, 0), double(most) / least);
  if (most == 100 && least == 25) text += "; the Fetch paper has 6.4";
  return text + "\n";
}

std::string table_two(const StudyInput& input, const StudyResult& result) {
  const auto groups = with_most(result);
  constexpr std::size_t kMost = 8;  // more do not fit beside each other
  if (groups.size() < 2 || groups.size() > kMost || groups.front()->trials < kForVariance)
    return "";
  std::vector<std::string> titles;
  for (const StudyGroup* group : groups)
    titles.push_back(fmt::format("robot {}", group->robot + 1));
  return fmt::format("Table II: the same of {}, {} poses\n", counted(groups.size(), "robot"),
                     groups.front()->poses) +
         variances(input, groups, titles, false);
}

std::string table_three(const StudyInput& input, const StudyResult& result) {
  const std::string unit = unit_of_study(input), shown = reading_unit(unit);
  TextTable table({"robot", "poses", "re-projection, " + shown, "without noise", "pose off, mm",
                   "varies", "predicted", "worst", "failed"},
                  0);
  constexpr int kMost = 20;
  const auto mm = [](double value) {
    return value > 0.0 ? fmt::format("{:.3f}", 1e3 * value) : std::string("-");
  };
  for (const StudyGroup& group : result.groups) {
    if (group.robot >= kMost) break;
    table.add({std::to_string(group.robot + 1), std::to_string(group.poses),
               in_reading_unit(group.reprojection, unit), in_reading_unit(group.systematic, unit),
               mm(group.position), mm(group.trials > 1 ? group.varied_position : 0.0),
               mm(group.predicted_position), mm(group.worst_position),
               fmt::format("{} of {}", group.failed, group.trials)});
  }
  std::string text =
      fmt::format("Table III: mean re-projection error on new samples, and error of '{}' in '{}'\n",
                  input.setup.frame.name(), input.setup.in.name());
  text += table.str();
  const int robots = robots_of(result);
  if (robots > kMost) text += fmt::format("  ... and {} more\n", robots - kMost);
  return text;
}

/// What six unknowns for the target of each sample would give.
std::string free_targets(const StudyInput& input, const StudyResult& result) {
  const auto groups = of_robot(result, 0);
  if (groups.empty() || !(groups.front()->free_targets > 0.0)) return "";
  TextTable table({"poses", "unknowns", "predicted, mm", "with free targets", "predicted, mm"}, 0);
  const std::size_t unknowns = input.setup.free.size();
  for (const StudyGroup* group : groups) {
    table.add({std::to_string(group->poses), std::to_string(unknowns),
               fmt::format("{:.3f}", 1e3 * group->predicted_position),
               std::to_string(unknowns + 6 * static_cast<std::size_t>(group->poses)),
               fmt::format("{:.3f}", 1e3 * group->free_targets)});
  }
  return "Free targets, as in the PR2's calibration: six unknowns for the pose of each sample's "
         "target\n" +
         table.str();
}

/// Sums over all robots.
std::string sums(const StudyInput& input, const StudyResult& result) {
  std::string text;
  int trials = 0, failed = 0, ruined = 0, left_out = 0;
  double before = 0.0, after = 0.0, most = 0.0;
  for (const StudyGroup& group : result.groups) {
    trials += group.trials;
    failed += group.failed;
    ruined += group.ruined;
    left_out += group.left_out;
    after += group.position * group.position * group.trials;
    most = std::max(most, group.worst_position);
  }
  for (const double of : result.before) before += of * of;
  const std::string unit = unit_of_study(input);
  text += fmt::format("{} of {} failed: mean re-projection error above {} {}, or not converged\n",
                      failed, counted(static_cast<std::size_t>(trials), "calibration"),
                      in_reading_unit(result.limit, unit), reading_unit(unit));
  text += fmt::format(
      "'{}' in '{}': {:.1f} mm by the URDF, {:.3f} mm calibrated (RMS), {:.3f} mm at worst\n",
      input.setup.frame.name(), input.setup.in.name(),
      1e3 * std::sqrt(before / std::max(1.0, static_cast<double>(result.before.size()))),
      1e3 * std::sqrt(after / std::max(1, trials)), 1e3 * most);
  if (result.remaining) {
    text += fmt::format("Even without noise {} {} remain\n",
                        in_reading_unit(systematic_error(result), unit), reading_unit(unit));
    if (result.remaining->robots > 0) text += remaining_text(*result.remaining);
  }
  if (ruined > 0) {
    text += fmt::format("{} ruined, {} left out\n",
                        counted(static_cast<std::size_t>(ruined), "sample"), left_out);
  }
  return text;
}

bool is_linear(const StudyGroup& group) {
  return group.ruined > 0 || group.nonlinearity < kLinear;
}

/// Parameters whose calibrations vary by more or less than chance explains, in a sentence; empty if none
/// do.
std::string beyond_chance(const StudyInput& input, const StudyResult& result) {
  const std::vector<std::string> names = free_names(input);
  constexpr double kChance = 0.001;  // that one of all parameters and groups is named by chance
  const double tail =
      0.5 * kChance / std::max(1.0, static_cast<double>(names.size() * result.groups.size()));
  std::string worst;
  double farthest = 0.0;
  int count = 0;
  for (const StudyGroup& group : result.groups) {
    if (group.trials < kForVariance || group.ruined > 0) continue;
    const auto [low, high] = spread_interval(group.trials - 1, tail);
    for (std::size_t p = 0; p < names.size(); ++p) {
      const ParameterSpread& of = group.parameters[p];
      if (!std::isfinite(of.predicted) || !(of.predicted > 0.0 && of.variance > 0.0)) continue;
      const double ratio = std::sqrt(of.variance / of.predicted);
      if (ratio >= low && ratio <= high) continue;
      ++count;
      if (std::abs(std::log(ratio)) <= farthest) continue;
      farthest = std::abs(std::log(ratio));
      worst = fmt::format("'{}' varies {:.2f} times as much as predicted (robot {}, {} poses)",
                          names[p], ratio, group.robot + 1, group.poses);
    }
  }
  if (count == 0) return "";
  return fmt::format("Not as predicted: {}, which chance does not explain{}\n", worst,
                     count == 1 ? "" : fmt::format("; nor {} more like it", count - 1));
}

/// Whether the covariance describes the trials.
std::string linearity(const StudyResult& result) {
  const auto worst = std::max_element(
      result.groups.begin(), result.groups.end(),
      [](const StudyGroup& a, const StudyGroup& b) { return a.nonlinearity < b.nonlinearity; });
  if (worst == result.groups.end()) return "";
  if (worst->ruined > 0) return "";
  if (worst->nonlinearity < kLinear) {
    return fmt::format(
        "Linear: residuals differ from those of the linearized problem by {:.1f} % of what its "
        "solution changes, at most\n",
        100.0 * worst->nonlinearity);
  }
  return fmt::format(
      "Not linear: with {} poses, residuals of robot {} differ from those of the linearized "
      "problem by "
      "{:.0f} % of what its solution changes; predicted variances do not hold there\n",
      worst->poses, worst->robot + 1, 100.0 * worst->nonlinearity);
}

}  // namespace

std::string unit_of_study(const StudyInput& input) {
  const AnyProblem& problem = *input.calibration.steps.back().problem;
  for (int t = 0; t < problem.num_terms(); ++t) {
    if (problem.samples_of(t) > 0) return problem.term(t).options.unit;
  }
  return "m";
}

double variance_ratio(const StudyResult& result, int robot) {
  const auto groups = of_robot(result, robot);
  if (groups.size() < 2) return 0.0;
  std::vector<double> ratios;
  for (std::size_t p = 0; p < groups.front()->parameters.size(); ++p) {
    const ParameterSpread &most = groups.front()->parameters[p],
                          &least = groups.back()->parameters[p];
    if (most.variance > 0.0 && std::isfinite(most.predicted)) {
      ratios.push_back(least.variance / most.variance);
    }
  }
  if (ratios.empty()) return 0.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

double systematic_error(const StudyResult& result) {
  double largest = 0.0;
  for (const StudyGroup& group : result.groups) largest = std::max(largest, group.systematic);
  return largest;
}

StudyText study_texts(const StudyInput& input, const StudyResult& result) {
  StudyText text;
  text.about =
      fmt::format("{}: {}, {} poses to choose from, {} free parameters\n", input.robot.name(),
                  counted(static_cast<std::size_t>(robots_of(result)), "robot"),
                  input.samples.size(), input.setup.free.size());
  if (result.done < result.jobs) {
    text.about +=
        fmt::format("Interrupted: {} of {} calibrations are done\n", result.done, result.jobs);
  }
  for (const auto& table : {table_one, table_two, table_three, free_targets}) {
    const std::string lines = table(input, result);
    if (!lines.empty()) text.tables.push_back(lines);
  }
  text.sums = sums(input, result);
  const std::string others = beyond_chance(input, result);
  text.linearity = linearity(result) + others;
  text.linear =
      others.empty() && std::all_of(result.groups.begin(), result.groups.end(), is_linear);
  return text;
}

std::string study_text(const StudyInput& input, const StudyResult& result) {
  const StudyText of = study_texts(input, result);
  std::string text = of.about;
  for (const std::string& table : of.tables) text += "\n" + table;
  return text + "\n" + of.sums + of.linearity;
}

std::string study_json(const StudyInput& input, const StudyResult& result) {
  using detail::Json;
  const std::vector<std::string> names = free_names(input);
  Json groups = Json::array();
  for (const StudyGroup& group : result.groups) {
    Json parameters = Json::array();
    for (std::size_t p = 0; p < names.size(); ++p) {
      const ParameterSpread& of = group.parameters[p];
      parameters.push_back({{"name", names[p]},
                            {"unit", unit_of(input, p)},
                            {"truth", of.truth},
                            {"mean", of.mean},
                            {"variance", of.variance},
                            {"predicted", of.predicted}});
    }
    groups.push_back({{"robot", group.robot + 1},
                      {"poses", group.poses},
                      {"trials", group.trials},
                      {"failed", group.failed},
                      {"ruined", group.ruined},
                      {"left_out", group.left_out},
                      {"position", group.position},
                      {"varied_position", group.varied_position},
                      {"predicted_position", group.predicted_position},
                      {"free_targets", group.free_targets},
                      {"worst_position", group.worst_position},
                      {"rotation", group.rotation},
                      {"reprojection", group.reprojection},
                      {"systematic", group.systematic},
                      {"nonlinearity", group.nonlinearity},
                      {"parameters", parameters}});
  }
  return detail::json_lines({{"robot", input.robot.name()},
                             {"frame", input.setup.frame.name()},
                             {"in", input.setup.in.name()},
                             {"unit", unit_of_study(input)},
                             {"limit", result.limit},
                             {"jobs", result.jobs},
                             {"done", result.done},
                             {"groups", groups}});
}

}  // namespace kinecal::cli
