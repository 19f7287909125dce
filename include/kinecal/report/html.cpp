// Writing the HTML report.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "kinecal/files/checksum.hpp"
#include "kinecal/report/chart_style.hpp"
#include "kinecal/report/charts/chart.hpp"
#include "kinecal/report/page_files.ipp"  // made when kinecal is configured, of page/
#include "kinecal/report/svg_text.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/characters.hpp"
#include "kinecal/text/first_names.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/text/shell_command.hpp"
#include "kinecal/trust/uncertainty/weak_parameters.hpp"

namespace kinecal {

namespace detail {

// The sections of the HTML report.

std::string html_text(std::string_view text) {
  return svg_escaped(text);
}

inline constexpr std::size_t kMostOfName = 80;  ///< characters

std::string html_name(std::string_view name) {
  const std::string text = shortened(name, kMostOfName);
  const bool whole = text.find("…") == std::string::npos || name.find("…") != std::string::npos;
  return (whole ? "<bdi>" : "<bdi title=\"" + html_text(name) + "\">") + html_text(text) + "</bdi>";
}

/// True if a word has to be isolated from its neighbours.
[[nodiscard]] inline bool has_right_to_left(std::string_view word) {
  for (std::size_t at = 0; at < word.size();) {
    if (is_right_to_left(next_character(word, at))) return true;
  }
  return false;
}

/// A sentence, in which names of the user's are as in html_name(): words that are long or from right to left.
/// @param whole  keeps long words: they are to be copied
[[nodiscard]] inline std::string html_sentence(std::string_view text, bool whole = false) {
  std::string html;
  while (!text.empty()) {
    const auto word_at = [&](std::size_t at) {
      return text.substr(at, std::min(text.find(' ', at + 1), text.size()) - at);
    };
    std::size_t end = word_at(0).size();
    if (!has_right_to_left(text.substr(0, end))) {
      const std::string_view word = text.substr(0, end);
      const std::size_t space = word.front() == ' ' ? 1 : 0;
      html += whole || word.size() <= kMostOfName
                  ? html_text(word)
                  : html_text(word.substr(0, space)) + html_name(word.substr(space));
    } else {
      while (end < text.size() && has_right_to_left(word_at(end))) end += word_at(end).size();
      const std::size_t space = text.front() == ' ' ? 1 : 0;
      const std::string_view name = text.substr(space, end - space);
      html.append(space, ' ');
      html += whole ? "<bdi>" + html_text(name) + "</bdi>" : html_name(name);
    }
    text.remove_prefix(end);
  }
  return html;
}

std::string html_figure(const Chart& chart) {
  const std::string caption =
      chart.caption.empty() ? "" : "<figcaption>" + html_text(chart.caption) + "</figcaption>";
  return fmt::format("<figure><h3>{}</h3>{}{}</figure>\n", html_text(chart.title), chart.svg,
                     caption);
}

std::string html_figures(std::vector<Chart> charts) {
  std::string drawn;
  std::set<std::string> said;
  for (Chart& chart : charts) {
    if (!said.insert(chart.caption).second) chart.caption.clear();
    drawn += html_figure(chart);
  }
  return drawn.empty() ? "" : "<div class=\"pair\">" + drawn + "</div>\n";
}

/// Wraps a table so that it scrolls separately, also with the keyboard.
[[nodiscard]] inline std::string scroll_region(const std::string& name) {
  return fmt::format(R"(<div class="scroll" tabindex="0" role="region" aria-label="{}">)",
                     html_text(name));
}

std::string html_table(const std::vector<std::vector<std::string>>& rows,
                       std::string_view columns) {
  std::string html = scroll_region(rows.front().front() + " table") + "<table class=\"numbers\">";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    html += r == 0 ? "<thead><tr>" : "<tr>";
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const char* kind = columns[c] == 't'   ? " class=\"text\""
                         : columns[c] == 'l' ? " class=\"long\""
                                             : "";
      html += r == 0 ? fmt::format("<th scope=\"col\"{}>{}</th>", kind, html_text(rows[r][c]))
                     : fmt::format("<td{}>{}</td>", kind,
                                   columns[c] == 't'   ? html_name(rows[r][c])
                                   : columns[c] == 'l' ? html_sentence(rows[r][c])
                                                       : html_text(rows[r][c]));
    }
    html += r == 0 ? "</tr></thead><tbody>" : "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

/// The page section for a chart: its own, if the page has it.
[[nodiscard]] inline std::string_view section_of(const Chart& chart) {
  if (chart.section == "residuals") return "samples";
  if (chart.section == "workspace") return "robot";
  const bool has_own =
      chart.section == "parameters" || chart.section == "search" || chart.section == "convergence";
  return has_own ? std::string_view(chart.section) : "errors";
}

/// A section: its figures, then its charts; empty if absent.
[[nodiscard]] inline std::string section(std::string_view id, std::string_view title,
                                         const std::string& figures,
                                         const std::vector<Chart>& charts) {
  std::vector<Chart> own;
  std::copy_if(charts.begin(), charts.end(), std::back_inserter(own),
               [&](const Chart& chart) { return section_of(chart) == id; });
  const std::string html = figures + html_figures(std::move(own));
  if (html.empty()) return "";
  return fmt::format("<section id=\"{}\"><h2>{}</h2>\n{}</section>\n", id, title, html);
}

/// The CSS class of a grade.
[[nodiscard]] inline std::string_view class_of(Grade grade) {
  return grade == Grade::good ? "good" : grade == Grade::use_with_care ? "care" : "bad";
}

[[nodiscard]] inline std::string html_navigation(bool has_scene, bool has_search) {
  std::string items;
  for (const auto& [id, title] :
       std::initializer_list<std::pair<const char*, const char*>>{{"errors", "Errors"},
                                                                  {"search", "Search"},
                                                                  {"samples", "Samples"},
                                                                  {"robot", "Robot"},
                                                                  {"parameters", "Parameters"},
                                                                  {"convergence", "Convergence"},
                                                                  {"inputs", "Inputs"}}) {
    if (std::string_view(id) == "robot" && !has_scene) continue;
    if (std::string_view(id) == "search" && !has_search) continue;
    items += fmt::format("<li><a href=\"#{}\">{}</a></li>", id, title);
  }
  return "<nav class=\"toc\" aria-label=\"Sections\"><ul>" + items + "</ul></nav>\n";
}

namespace {

// The tables of the HTML report.

/// Before, fitted and held out, of each error block.
[[nodiscard]] std::string fit_figures(const ReportData& data) {
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
[[nodiscard]] std::string worst_samples(const ReportData& data) {
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
[[nodiscard]] std::string unobservable_text(const ReportData& data) {
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

/// The frames whose pose was not known: it was found, not corrected.
[[nodiscard]] std::set<std::string> unknown_frames(const ReportData& data) {
  std::set<std::string> unknown;
  for (const StepResult& step : data.steps) {
    unknown.insert(step.starts.frames.begin(), step.starts.frames.end());
  }
  return unknown;
}

[[nodiscard]] std::string parameter_figures(const ReportData& data) {
  const std::set<std::string> unknown = unknown_frames(data);
  std::vector<std::vector<std::string>> rows = {
      {"parameter", "calibrated", "±", "from", "unit", ""}};
  for (const ReportedParameter& parameter : data.parameters) {
    if (parameter.note == kInCamera) continue;
    const auto [value, unit] = for_people(parameter.value, parameter.unit);
    rows.push_back({parameter.name, value,
                    parameter.sigma ? for_people(*parameter.sigma, parameter.unit).first : "-",
                    unknown.contains(parameter.owner)
                        ? "-"
                        : for_people(parameter.initial, parameter.unit).first,
                    unit, parameter.note});
  }
  const bool turns = std::any_of(
      data.parameters.begin(), data.parameters.end(), [](const ReportedParameter& parameter) {
        return parameter.unit == "rad" && is_frame_parameter(parameter.name, parameter.owner);
      });
  return unobservable_text(data) + "<p>&plusmn; is one standard deviation" + (turns ? "; " : "") +
         (turns ? kAxesOfFrames : "") + ".</p>\n" + html_table(rows, "tnnntt");
}

/// What each step of a search bought, and what was tried and not freed.
[[nodiscard]] std::string search_figures(const ReportData& data) {
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

[[nodiscard]] std::string step_figures(const ReportData& data) {
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
[[nodiscard]] std::string inputs_section(const ReportData& data) {
  return fmt::format(
      "<section id=\"inputs\"><h2>Inputs</h2>\n{}"
      "<details><summary>The report as text</summary><pre>{}</pre></details></section>\n",
      html_inputs(data.inputs, data.version, data.command), html_lines(data.summary));
}

// The top of a report's page: the verdict, what to do next, what was wrong.

/// Significant changes, most important first: relative to the useful deviation.
[[nodiscard]] std::vector<const ReportedParameter*> largest_changes(const ReportData& data) {
  std::vector<const ReportedParameter*> all;
  const std::set<std::string> unknown = unknown_frames(data);
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
[[nodiscard]] std::string what_was_wrong(const ReportData& data) {
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

/// What cameras are, in a list each: "fx 800.12 ± 0.05", ..., and how well a pixel is known.
[[nodiscard]] std::string cameras_found(const ReportData& data) {
  std::string html;
  for (const ProjectionMap& map : data.cameras) {
    std::string numbers = camera_numbers(map);
    if (numbers.empty()) continue;
    for (const auto& [from, to] : {std::pair("; ", "</li><li>"), std::pair(" +- ", " &plusmn; ")}) {
      for (std::size_t at = 0; (at = numbers.find(from, at)) != std::string::npos;) {
        numbers.replace(at, std::string_view(from).size(), to);
      }
    }
    const double known = map.deviations()[1];
    html +=
        fmt::format("<div><h3>Camera <code>{}</code></h3><ul><li>{}</li><li>{}</li></ul></div>\n",
                    html_name(map.sensor), numbers,
                    std::isfinite(known)
                        ? fmt::format("a pixel is known to <strong>{}</strong> where features are",
                                      reading(known, "px"))
                        : "its pixels are not determined");
  }
  return html;
}

/// Samples that do not fit, in a list.
[[nodiscard]] std::string bad_samples(const ReportData& data) {
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
[[nodiscard]] std::string fit_sentence(const ReportData& data) {
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
  for (const PoseUncertainty& pose : data.compared) {
    constexpr double kKnown = 0.35;  // radians; the orientation of a point is meaningless
    html += fmt::format("<p>{}<code>{}</code> in <code>{}</code> is known to {}{}</p>",
                        read_back.is_worse ? "With <code>calibration.yaml</code>, " : "",
                        html_name(pose.frame), html_name(pose.in),
                        read_back.is_worse ? reading(pose.position, "m")
                                           : "<strong>" + reading(pose.position, "m") + "</strong>",
                        pose.rotation < kKnown ? ", " + reading(pose.rotation, "rad") : "");
  }
  for (const PoseUncertainty& pose : data.between) {
    html += pose.determined
                ? fmt::format("<p><code>{}</code> in <code>{}</code> is known to {}, {}</p>",
                              html_name(pose.frame), html_name(pose.in),
                              reading(pose.position, "m"), reading(pose.rotation, "rad"))
                : fmt::format("<p><code>{}</code> in <code>{}</code> is not determined</p>",
                              html_name(pose.frame), html_name(pose.in));
  }
  return html + "</div>\n";
}

/// What to do next: a sentence, and a command to copy.
[[nodiscard]] std::string html_next(const std::string& next) {
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
[[nodiscard]] std::string html_top(const ReportData& data) {
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
      "<div class=\"facts\">{}{}{}{}</div>\n</header>\n",
      class_of(data.verdict), html_name(data.robot), to_string(data.verdict), html_sentence(about),
      reasons.empty() ? "" : "<ul class=\"reasons\">" + reasons + "</ul>\n", html_next(data.next),
      cameras_found(data), fit_sentence(data), what_was_wrong(data), bad_samples(data));
}

}  // namespace

inline constexpr std::size_t kMostOfTitle = 120;  ///< characters

/// "'sha256-...'", the form of a text in a content security policy.
[[nodiscard]] inline std::string policy_source(std::string_view text) {
  const auto digest = sha256(text);
  return "'sha256-" + base64(std::string(digest.begin(), digest.end())) + "'";
}

/// The 3-D view, with a sentence for browsers without script.
[[nodiscard]] inline std::string view_figure() {
  return "<figure id=\"view3d\" class=\"view3d\"><canvas aria-label=\"The robot in 3-D, before and "
         "after the calibration\"></canvas><div class=\"controls\"></div>"
         "<noscript><p class=\"note\">The robot is drawn by a script; this page has it, but the "
         "browser does not run it.</p></noscript><figcaption>Lines lead from measured to predicted "
         "points. A click on a sample in a chart or table shows it here.</figcaption></figure>\n";
}

std::string html_inputs(const std::vector<InputFile>& inputs, const std::string& version,
                        const ShellCommand& command) {
  std::vector<std::vector<std::string>> rows = {{"input", "file", "SHA-256", "bytes"}};
  for (const InputFile& input : inputs) {
    rows.push_back({input.role, input.name, input.sha256, fmt::format("{}", input.bytes)});
  }
  return fmt::format("{}<p>{}, repeated by</p>\n<pre class=\"command\"><code>{}</code></pre>\n",
                     html_table(rows, "tttn"), html_sentence(version),
                     html_sentence(command.str(), true));
}

std::string html_lines(std::string_view text) {
  std::string html;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    html += html_sentence(text.substr(at, end - at), true) + "\n";
    at = end + 1;
  }
  return html;
}

std::string html_paragraphs(std::string_view text) {
  std::string html;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (end > at) html += "<p>" + html_sentence(text.substr(at, end - at)) + "</p>\n";
    at = end + 1;
  }
  return html;
}

}  // namespace detail

std::string html_file(const HtmlPage& page) {
  const std::string style = std::string(detail::kPageStyle) + chart_style();
  const std::string script(detail::kPageScript);
  const std::string policy = fmt::format(
      "default-src 'none'; style-src {}; script-src {}; img-src data:; base-uri 'none'; "
      "form-action 'none'",
      detail::policy_source(style), detail::policy_source(script));
  std::string text = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<meta name=\"generator\" content=\"{}\"/>\n<link rel=\"icon\" href=\"data:,\"/>\n"
      "<title>{}</title>\n",
      policy, detail::html_text(page.version),
      detail::html_text(detail::shortened(page.title, detail::kMostOfTitle)));
  text += "<style>" + style + "</style>\n</head>\n<body>\n" + page.body;
  if (!page.scene.empty()) {
    text += "<script type=\"application/json\" id=\"scene\">" + page.scene + "</script>\n";
  }
  return text + "<script>" + script + "</script>\n</body>\n</html>\n";
}

std::string html_report(const ReportData& data, const std::string& scene) {
  const std::vector<Chart> all = charts(data);
  std::string body = detail::html_top(data);
  body += detail::html_navigation(!scene.empty() || !data.workspace.empty(),
                                  !data.search.steps.empty());
  body += "<main>\n";
  body += detail::section("errors", "Errors", detail::fit_figures(data), all);
  body += detail::section("search", "Search", detail::search_figures(data), all);
  body += detail::section("samples", "Samples", detail::worst_samples(data), all);
  body += detail::section("robot", "Robot", scene.empty() ? "" : detail::view_figure(), all);
  body += detail::section("parameters", "Parameters", detail::parameter_figures(data), all);
  body += detail::section("convergence", "Convergence", detail::step_figures(data), all);
  body += detail::inputs_section(data);
  body += "</main>\n";
  return html_file({data.robot + ": " + std::string(to_string(data.verdict)) + " - calibration",
                    data.version, body, scene});
}

}  // namespace kinecal
