// The sections of the HTML report.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/html.hpp"
#include "kinecal/report/svg_text.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/characters.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal::detail {

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
  return fmt::format("<figure><h3>{}</h3>{}<figcaption>{}</figcaption></figure>\n",
                     html_text(chart.title), chart.svg, html_text(chart.caption));
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
  std::string drawn;
  for (const Chart& chart : charts) {
    if (section_of(chart) == id) drawn += html_figure(chart);
  }
  if (figures.empty() && drawn.empty()) return "";
  const std::string html =
      figures + (drawn.empty() ? "" : "<div class=\"pair\">" + drawn + "</div>\n");
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

}  // namespace kinecal::detail
