// SPDX-License-Identifier: Apache-2.0
#include "plan_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/html.hpp"
#include "report.hpp"

namespace kinecal::cli {
namespace {

/// Accuracy by number of poses, those of the random sets.
std::string curve_table(const PoseCurve& curve) {
  const auto shown = [](double metres) {
    return std::isfinite(metres) ? fmt::format("{:.3f}", 1e3 * metres) : std::string("-");
  };
  std::vector<std::vector<std::string>> rows = {
      {curve.have > 0 ? "more poses" : "poses", "selected, mm", "random, mm"}};
  for (const PoseAccuracy& random : curve.random) {
    const auto selected =
        std::find_if(curve.selected.begin(), curve.selected.end(),
                     [&](const PoseAccuracy& point) { return point.poses == random.poses; });
    if (selected == curve.selected.end()) continue;
    rows.push_back(
        {std::to_string(random.poses), shown(selected->position), shown(random.position)});
  }
  return detail::html_table(rows, "nnn");
}

/// What is found, without what the headline says.
std::string beside_headline(const PlanFindings& findings) {
  std::string about = findings.about;
  for (const std::string& said : {findings.title + ": ", "; " + findings.title}) {
    if (const auto at = about.find(said); at != std::string::npos) about.erase(at, said.size());
  }
  return about;
}

}  // namespace

std::string plan_page(const StudyInput& input, const PlanFindings& findings) {
  const std::size_t title = std::min(findings.lost.find('\n'), findings.lost.size() - 1) + 1;
  std::string lost = detail::html_paragraphs(findings.lost.substr(0, title));
  if (title < findings.lost.size()) {
    lost += "<pre>" + detail::html_lines(findings.lost.substr(title)) + "</pre>\n";
  }
  const std::string body = fmt::format(
      "<header class=\"verdict {}\">\n<h1>{}: <strong>{}</strong></h1>\n<div>{}</div>\n"
      "</header>\n<main>\n"
      "<section id=\"poses\"><h2>How many poses</h2>\n<div class=\"pair\">{}<figure>"
      "<h3>In numbers</h3>{}</figure></div>\n</section>\n"
      "<section id=\"parameters\"><h2>What these poses determine</h2>\n{}</section>\n{}</main>\n",
      findings.reached ? "good" : "care", detail::html_name(input.robot.name()),
      detail::html_text(findings.title), detail::html_paragraphs(beside_headline(findings)),
      detail::html_figure(pose_curve_chart(findings.curve)), curve_table(findings.curve), lost,
      study_inputs(input));
  return html_file({input.robot.name() + ": " + findings.title, version(), body, ""});
}

}  // namespace kinecal::cli
