// The tables of the HTML report.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/charts/chart.hpp"
#include "kinecal/report/html.hpp"
#include "kinecal/report/html_sections.ipp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/first_names.hpp"
#include "kinecal/text/shell_command.hpp"

namespace kinecal::detail {

/// Before, fitted and held out, of each error block.
[[nodiscard]] inline std::string fit_figures(const ReportData& data) {
  std::vector<std::vector<std::string>> rows = {
      {"error block", "before", "fitted", "held out", "noise", "sigma given", "unit", "features"}};
  for (const ReportedBlock& block : data.blocks) {
    const auto text = [&](double value) { return in_reading_unit(value, block.unit); };
    const auto used =
        std::count_if(block.features.begin(), block.features.end(),
                      [&](const auto& feature) { return !sample_of(data, feature).left_out; });
    rows.push_back({block.name, text(block.rms_before), text(block.rms_after),
                    block.held_out ? text(*block.held_out) : "-",
                    block.sigma > 0.0 ? text(block.sigma) : "-",
                    block.sigma_given > 0.0 ? text(block.sigma_given) : "-",
                    reading_unit(block.unit), fmt::format("{}", used)});
  }
  return "<p>Distances of features, root of the mean square; noise of a coordinate.</p>\n" +
         html_table(rows, "tnnnnntn");
}

/// Samples that do not fit, and the worst of the others.
[[nodiscard]] inline std::string worst_samples(const ReportData& data) {
  std::vector<const ReportedSample*> worst;
  for (const ReportedSample& sample : data.samples) {
    if (sample.bad || sample.left_out || sample.times > 0.0) worst.push_back(&sample);
  }
  std::stable_sort(worst.begin(), worst.end(), [](const auto* a, const auto* b) {
    return std::pair(a->left_out, a->times) > std::pair(b->left_out, b->times);
  });
  constexpr std::size_t kListed = 20;
  std::string html =
      scroll_region("samples") +
      "<table class=\"numbers\"><thead><tr><th scope=\"col\">sample</th>"
      "<th scope=\"col\">times the noise</th><th scope=\"col\" class=\"long\">remark</th>"
      "<th scope=\"col\" class=\"text\">recorded at</th></tr></thead><tbody>";
  for (std::size_t i = 0; i < std::min(kListed, worst.size()); ++i) {
    const ReportedSample& sample = *worst[i];
    html += fmt::format(
        "<tr{}><td><a href=\"#sample={}\" data-sample=\"{}\">{}</a></td><td>{}</td>"
        "<td class=\"long\">{}{}</td><td class=\"text\">{}</td></tr>\n",
        sample.bad ? " class=\"bad\"" : "", sample.number, sample.number, sample.number,
        sample.times > 0.0 ? fmt::format("{:.1f}", sample.times) : "-",
        sample.left_out ? "left out: " : "", html_sentence(sample.why), html_name(sample.source));
  }
  html += "</tbody></table></div>\n";
  if (worst.size() > kListed) {
    html +=
        fmt::format("<p class=\"note\">The worst {} of {} samples.</p>\n", kListed, worst.size());
  }
  return html;
}

/// What no sample determines, and what to hold.
[[nodiscard]] inline std::string unobservable_text(const ReportData& data) {
  if (data.unobservable.empty()) return "";
  std::string html = fmt::format(
      "<div class=\"open\"><h3>Not determined by these samples</h3><p>{} of {} parameters: no "
      "residual "
      "changes along</p><ul>",
      data.unobservable.size(), static_cast<std::size_t>(data.rank) + data.unobservable.size());
  constexpr std::size_t kCombinations = 12, kParameters = 5;
  for (std::size_t c = 0; c < std::min(kCombinations, data.unobservable.size()); ++c) {
    const auto& combination = data.unobservable[c];
    html += "<li>";
    for (std::size_t i = 0; i < std::min(kParameters, combination.size()); ++i) {
      html += fmt::format("{:+.3g}&nbsp;<code>{}</code> ", combination[i].second,
                          html_name(combination[i].first));
    }
    html += combination.size() > kParameters ? "&hellip;</li>" : "</li>";
  }
  html += "</ul>";
  if (!data.hold.empty()) {
    const std::string hold = ShellCommand().add_names("--hold", data.hold).str();
    html += "<p>Hold these to determine the others: <code>" + html_sentence(hold, true) +
            "</code>. Poses that move the joints between them apart, or another target, determine "
            "them as well.</p>";
  }
  return html + "</div>\n";
}

[[nodiscard]] inline std::string parameter_figures(const ReportData& data) {
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "calibrated", "±", "from", "unit", ""}};
  for (const ReportedParameter& parameter : data.parameters) {
    const auto [value, unit] = for_people(parameter.value, parameter.unit);
    rows.push_back({parameter.name, value,
                    parameter.sigma ? for_people(*parameter.sigma, parameter.unit).first : "-",
                    for_people(parameter.initial, parameter.unit).first, unit, parameter.note});
  }
  return unobservable_text(data) + "<p>With one standard deviation.</p>\n" +
         html_table(rows, "tnnntt");
}

/// What each step of a search bought, and what was tried and not freed.
[[nodiscard]] inline std::string search_figures(const ReportData& data) {
  if (data.search.steps.empty()) return "";
  const std::string& of = data.search.unit;
  std::vector<std::vector<std::string>> rows = {{"freed", "parameters", "fitted", "held out", "±",
                                                 "regions held out", "unit", "times its ±",
                                                 "explains the same"}};
  const auto text = [&](double value) {
    return std::isfinite(value) ? in_reading_unit(value, of) : std::string("-");
  };
  for (const ReportedSearchStep& step : data.search.steps) {
    rows.push_back({step.freed.empty() ? "(only unknown poses)"
                    : step.is_chosen   ? step.freed
                                       : "not freed: " + step.freed,
                    fmt::format("{}", step.parameters), text(step.fitted), text(step.held_out),
                    std::isfinite(step.held_out) ? text(step.deviation) : "-",
                    step.region > 0.0 ? text(step.region) : "-",
                    of == "1" ? "x noise" : reading_unit(of),
                    step.freed.empty() ? "" : fmt::format("{:.1f}", std::abs(step.certainty)),
                    first_names(step.alike)});
  }
  return "<p>A search chose the free parameters; each row has those above it free, too. ± is the "
         "standard error of the error on held-out poses. The last columns: how much that error "
         "would "
         "rise without this one alone, in standard errors, and what would explain the same in "
         "place of it.</p>\n" +
         html_table(rows, "tnnnnntnl");
}

[[nodiscard]] inline std::string step_figures(const ReportData& data) {
  std::vector<std::vector<std::string>> rows = {
      {"step", "ended", "parameters", "residuals", "cost before", "after", "iterations"}};
  for (const StepResult& step : data.steps) {
    rows.push_back({step.name, step.termination, fmt::format("{}", step.num_parameters),
                    fmt::format("{}", step.num_residuals), fmt::format("{:.6g}", step.initial_cost),
                    fmt::format("{:.6g}", step.final_cost), fmt::format("{}", step.iterations)});
  }
  std::string html = html_table(rows, "tlnnnnn");
  for (const StepResult& step : data.steps) {
    if (step.starts.searched()) html += "<p>" + html_sentence(to_string(step.starts)) + "</p>\n";
  }
  return html;
}

/// The inputs, the command that repeats the run, and the report as text.
[[nodiscard]] inline std::string inputs_section(const ReportData& data) {
  return fmt::format(
      "<section id=\"inputs\"><h2>Inputs</h2>\n{}"
      "<details><summary>The report as text</summary><pre>{}</pre></details></section>\n",
      html_inputs(data.inputs, data.version, data.command), html_lines(data.summary));
}

}  // namespace kinecal::detail
