// The report as one HTML file that opens anywhere: verdict, errors, parameters, the robot in 3-D.
//
// The file loads nothing: it contains style and script, and its content security policy forbids
// anything else.  All text from user files is escaped.  The same data give the same bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/report/charts/charts.hpp"
#include "kinecal/report/report_data.hpp"

namespace kinecal {

/// A whole page.
struct HtmlPage {
  std::string title;    ///< plain text
  std::string version;  ///< "kinecal 0.2.0"
  std::string body;     ///< HTML
  std::string scene;    ///< JSON of the 3-D view; empty: none
};

/// The page as a file, with style, script and content security policy.
[[nodiscard]] std::string html_file(const HtmlPage& page);

/// The report of a calibration.
/// @param scene  JSON of the 3-D view: see scene_json(); empty: none
[[nodiscard]] std::string html_report(const ReportData& data, const std::string& scene);

namespace detail {

/// Plain text as escaped HTML; replaces what is not UTF-8, or not allowed in HTML.
[[nodiscard]] std::string html_text(std::string_view text);

/// A name of the user's: a long one is shortened, with the whole name as tooltip; one from right to left does
/// not turn what is beside it.
[[nodiscard]] std::string html_name(std::string_view name);

/// The same for lines that stay lines: for <pre>.
[[nodiscard]] std::string html_lines(std::string_view text);

/// The same for lines that become paragraphs.
[[nodiscard]] std::string html_paragraphs(std::string_view text);

/// A chart with its caption.
[[nodiscard]] std::string html_figure(const Chart& chart);

/// Charts beside each other; a caption of several stands below the first of them.  Empty if there are none.
[[nodiscard]] std::string html_figures(std::vector<Chart> charts);

/// A table; cells are plain text, the first row is the header.
/// @param columns  the kind of each column: 't' short text, 'l' long text, 'n' a number
[[nodiscard]] std::string html_table(const std::vector<std::vector<std::string>>& rows,
                                     std::string_view columns);

/// The input files, and the command that repeats the run.
/// @param version  "kinecal 0.2.0"
[[nodiscard]] std::string html_inputs(const std::vector<InputFile>& inputs,
                                      const std::string& version, const ShellCommand& command);

}  // namespace detail

}  // namespace kinecal
