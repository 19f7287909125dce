// SPDX-License-Identifier: Apache-2.0
#include "study_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "kinecal/report/charts/position_spread.hpp"
#include "kinecal/report/charts/spread.hpp"
#include "kinecal/report/html.hpp"
#include "kinecal/text/counted.hpp"
#include "report.hpp"

namespace kinecal::cli {
namespace {

/// Groups of all robots by number of poses, the most first: those whose variances are known and
/// predicted.
using GroupsByPoses = std::map<int, std::vector<const StudyGroup*>, std::greater<>>;

GroupsByPoses groups_by_poses(const StudyResult& result) {
  GroupsByPoses groups;
  for (const StudyGroup& group : result.groups) {
    if (group.trials > 1 && group.predicted_position > 0.0) groups[group.poses].push_back(&group);
  }
  return groups;
}

/// Ratios of a parameter over all robots: each has its own mean.
SpreadSeries series_of(int poses, const std::vector<const StudyGroup*>& groups,
                       std::size_t parameters) {
  SpreadSeries series{counted(static_cast<std::size_t>(poses), "pose"), 0,
                      std::vector<double>(parameters, 0.0)};
  for (const StudyGroup* group : groups) {
    const int freedom = group->trials - 1;
    series.freedom += freedom;
    for (std::size_t p = 0; p < parameters; ++p) {
      const ParameterSpread& of = group->parameters[p];
      const bool known = std::isfinite(of.predicted) && of.predicted > 0.0;
      series.ratios[p] +=
          known ? freedom * of.variance / of.predicted : std::numeric_limits<double>::quiet_NaN();
    }
  }
  for (double& ratio : series.ratios) ratio = std::sqrt(ratio / series.freedom);
  return series;
}

/// With the most and with the fewest poses.
SpreadRatios ratios_of(const StudyInput& input, const GroupsByPoses& groups) {
  SpreadRatios ratios{free_names(input), {}};
  const auto add = [&](const auto& of) {
    ratios.series.push_back(series_of(of.first, of.second, ratios.parameters.size()));
  };
  add(*groups.begin());
  if (groups.size() > 1) add(*groups.rbegin());
  return ratios;
}

/// Root of the mean square of all robots.
std::vector<PositionSpread> positions_of(const GroupsByPoses& groups) {
  std::vector<PositionSpread> points;
  for (auto of = groups.rbegin(); of != groups.rend(); ++of) {
    PositionSpread point{of->first};
    for (const StudyGroup* group : of->second) {
      const double share = 1.0 / static_cast<double>(of->second.size());
      point.varied += share * group->varied_position * group->varied_position;
      point.predicted += share * group->predicted_position * group->predicted_position;
      point.off += share * group->position * group->position;
    }
    point.varied = std::sqrt(point.varied);
    point.predicted = std::sqrt(point.predicted);
    point.off = std::sqrt(point.off);
    points.push_back(point);
  }
  return points;
}

/// Why there are no charts.
std::string without_charts(const StudyResult& result) {
  const bool repeated = std::any_of(result.groups.begin(), result.groups.end(),
                                    [](const StudyGroup& group) { return group.trials > 1; });
  return repeated ? "The covariance predicts no variation, as without noise: there is nothing to "
                    "compare the calibrations with."
                  : "One calibration of a robot says nothing of repeatability.";
}

std::string charts_of(const StudyInput& input, const StudyResult& result) {
  const GroupsByPoses groups = groups_by_poses(result);
  if (groups.empty()) return "<p>" + detail::html_text(without_charts(result)) + "</p>\n";
  const std::size_t robots = groups.begin()->second.size();
  std::string html = "<div class=\"pair\">";
  Chart spread = spread_chart(ratios_of(input, groups));
  if (robots > 1) spread.caption += " All " + counted(robots, "robot") + " together.";
  html += detail::html_figure(spread);
  if (groups.size() > 1) {
    Chart position = position_spread_chart(positions_of(groups));
    position.caption = "'" + input.setup.frame.name() + "' in '" + input.setup.in.name() + "'. " +
                       position.caption;
    if (robots > 1) position.caption += " Root of the mean square of the robots.";
    html += detail::html_figure(position);
  }
  return html + "</div>\n";
}

/// Tables under their titles.
std::string tables_of(const StudyText& text) {
  std::string html;
  for (const std::string& table : text.tables) {
    const std::size_t end = table.find('\n');
    html += fmt::format("<h3>{}</h3>\n<pre>{}</pre>\n", detail::html_text(table.substr(0, end)),
                        detail::html_lines(table.substr(end + 1)));
  }
  return html;
}

}  // namespace

std::string study_page(const StudyInput& input, const StudyResult& result) {
  const StudyText text = study_texts(input, result);
  int trials = 0, failed = 0;
  for (const StudyGroup& group : result.groups) {
    trials += group.trials;
    failed += group.failed;
  }
  const std::string title = fmt::format("{} of {} failed", failed,
                                        counted(static_cast<std::size_t>(trials), "calibration"));
  const std::string body = fmt::format(
      "<header class=\"verdict {}\">\n<h1>{}: <strong>{}</strong></h1>\n"
      "<div>{}</div>\n</header>\n<main>\n"
      "<section id=\"repeatability\"><h2>Repeatability</h2>\n{}</section>\n"
      "<section id=\"tables\"><h2>Tables</h2>\n{}</section>\n{}</main>\n",
      failed == 0 && text.linear ? "good" : "care", detail::html_name(input.robot.name()), title,
      detail::html_paragraphs(text.about + text.sums + text.linearity), charts_of(input, result),
      tables_of(text), study_inputs(input));
  return html_file({input.robot.name() + ": " + title, version(), body, ""});
}

}  // namespace kinecal::cli
