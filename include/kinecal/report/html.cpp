// Writing the HTML report.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/html.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "kinecal/files/checksum.hpp"
#include "kinecal/report/chart_style.hpp"
#include "kinecal/report/html_sections.ipp"
#include "kinecal/report/html_tables.ipp"
#include "kinecal/report/html_top.ipp"
#include "kinecal/report/page_files.ipp"  // made when kinecal is configured, of page/

namespace kinecal {

namespace detail {

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
