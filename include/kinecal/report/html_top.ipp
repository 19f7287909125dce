// The top of a report's page: the verdict, what to do next, what was wrong.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "kinecal/report/html_sections.ipp"
#include "kinecal/text/reading.hpp"
#include "kinecal/trust/weak_parameters.hpp"

namespace kinecal::detail {

/// Significant changes, most important first: relative to the useful deviation.
[[nodiscard]] inline std::vector<const ReportedParameter*> largest_changes(const ReportData& data) {
  std::vector<const ReportedParameter*> all;
  std::set<std::string> unknown;  // an unknown pose is not corrected
  for (const StepResult& step : data.steps) {
    unknown.insert(step.starts.frames.begin(), step.starts.frames.end());
  }
  for (const ReportedParameter& parameter : data.parameters) {
    if (unknown.contains(parameter.owner)) continue;
    if (parameter.note.empty() && parameter.sigma && parameter.value != parameter.initial) {
      all.push_back(&parameter);
    }
  }
  const auto size = [](const ReportedParameter* p) {
    const double useful = useful_deviation({.name = p->name, .unit = p->unit});
    return std::abs(p->value - p->initial) / (std::isfinite(useful) ? useful : 1.0);
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const auto* a, const auto* b) { return size(a) > size(b); });
  constexpr std::size_t kListed = 5;
  if (all.size() > kListed) all.resize(kListed);
  return all;
}

/// "What was wrong", in a list.
[[nodiscard]] inline std::string what_was_wrong(const ReportData& data) {
  std::string items;
  for (const ReportedParameter* parameter : largest_changes(data)) {
    const auto [change, unit] = for_people(parameter->value - parameter->initial, parameter->unit);
    items += fmt::format("<li><code>{}</code> {} {} <span class=\"note\">&plusmn; {}</span></li>",
                         html_name(parameter->name), html_text(change), html_text(unit),
                         html_text(for_people(*parameter->sigma, parameter->unit).first));
  }
  if (items.empty()) return "";
  return "<div><h3>Largest corrections</h3><ul>" + items + "</ul></div>\n";
}

/// Samples that do not fit, in a list.
[[nodiscard]] inline std::string bad_samples(const ReportData& data) {
  constexpr int kListed = 5;
  int bad = 0;
  std::string items;
  for (const ReportedSample& sample : data.samples) {
    if (!sample.bad || ++bad > kListed) continue;
    items +=
        fmt::format("<li><a href=\"#sample={0}\" data-sample=\"{0}\">sample {0}</a> {1}: {2}</li>",
                    sample.number, html_name(sample.source), html_sentence(sample.why));
  }
  if (items.empty()) return "<div><h3>Bad captures</h3><p>none</p></div>\n";
  if (bad > kListed) items += fmt::format("<li>and {} more</li>", bad - kListed);
  return "<div><h3>Bad captures</h3><ul>" + items + "</ul></div>\n";
}

/// "hand_eye 34.1 -> 0.9 mm"
[[nodiscard]] inline std::string fit_sentence(const ReportData& data) {
  std::string items;
  for (const ReportedBlock& block : data.blocks) {
    items += fmt::format("<li><code>{}</code> {} &rarr; <strong>{}</strong> {}</li>",
                         html_name(block.name), in_reading_unit(block.rms_before, block.unit),
                         in_reading_unit(block.rms_after, block.unit), reading_unit(block.unit));
  }
  std::string html = "<div><h3>Fit, before and after</h3><ul>" + items + "</ul>";
  const ReadBack& read_back = data.read_back;
  if (read_back.is_worse) {
    html += fmt::format("<p>by the URDF alone: <strong>{}</strong></p>",
                        html_sentence(errors_text(read_back.of(read_back.judged)->errors)));
  }
  if (data.pose) {
    constexpr double kKnown = 0.35;  // radians; the orientation of a point is meaningless
    html += fmt::format(
        "<p>{}<code>{}</code> in <code>{}</code> is known to {}{}</p>",
        read_back.is_worse ? "With <code>calibration.yaml</code>, " : "",
        html_name(data.pose->frame), html_name(data.pose->in),
        read_back.is_worse ? reading(data.pose->position, "m")
                           : "<strong>" + reading(data.pose->position, "m") + "</strong>",
        data.pose->rotation < kKnown ? ", " + reading(data.pose->rotation, "rad") : "");
  }
  return html + "</div>\n";
}

/// What to do next: a sentence, and a command to copy.
[[nodiscard]] inline std::string html_next(const std::string& next) {
  if (next.empty()) return "";
  const std::size_t line = std::min(next.find("\n"), next.size());
  std::string html = "<p>Next: " + html_sentence(next.substr(0, line)) + "</p>";
  if (line < next.size()) {
    html += "<pre class=\"command\"><code>" +
            html_sentence(next.substr(next.find_first_not_of("\n ", line)), true) + "</code></pre>";
  }
  return html + "\n";
}

/// Verdict, reasons, what was wrong, bad captures.
[[nodiscard]] inline std::string html_top(const ReportData& data) {
  std::string reasons;
  for (const std::string& reason : data.reasons)
    reasons += "<li>" + html_sentence(reason) + "</li>";
  for (const std::string& help : data.helps)
    reasons += "<li>Would help: " + html_sentence(help) + "</li>";
  const auto left_out = std::count_if(data.samples.begin(), data.samples.end(),
                                      [](const ReportedSample& sample) { return sample.left_out; });
  std::string about = fmt::format("{} samples", data.solved);
  if (left_out > 0) about += fmt::format(", {} left out", left_out);
  if (data.drawn > 0) about += fmt::format(", judged on {} of them drawn evenly", data.drawn);
  if (!data.recorded.empty()) about += ", recorded " + data.recorded;
  if (!data.date.empty()) about += ", calibrated " + data.date;
  return fmt::format(
      "<header class=\"verdict {}\">\n"
      "<h1>{}: <strong>{}</strong></h1>\n<p class=\"note\">{}</p>\n{}{}"
      "<div class=\"facts\">{}{}{}</div>\n</header>\n",
      class_of(data.verdict), html_name(data.robot), to_string(data.verdict), html_sentence(about),
      reasons.empty() ? "" : "<ul class=\"reasons\">" + reasons + "</ul>\n", html_next(data.next),
      fit_sentence(data), what_was_wrong(data), bad_samples(data));
}

}  // namespace kinecal::detail
