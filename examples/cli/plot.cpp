// kinecal plot: the charts of a report as SVG files.
//
// A report holds each chart as an svg with its name in data-chart, so nothing is computed again: what
// a paper shows is what the report showed.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/report/chart_style.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// A chart as the report has it.
struct PlottedChart {
  std::string name, title;
  std::string_view svg;
};

/// What stands between two texts, from a place on; empty if either is missing.
std::string_view between(std::string_view text, std::string_view begin, std::string_view end) {
  const std::size_t from = text.find(begin);
  if (from == std::string_view::npos) return {};
  const std::size_t start = from + begin.size(), to = text.find(end, start);
  return to == std::string_view::npos ? std::string_view() : text.substr(start, to - start);
}

/// A name of ours, which is safe as that of a file.
bool is_chart_name(std::string_view name) {
  constexpr std::size_t kLongest = 100;
  return !name.empty() && name.size() <= kLongest &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-") == std::string_view::npos;
}

std::string unescaped(std::string_view text) {
  std::string plain(text);
  for (const auto& [from, to] :  // the marks around a name that is written from right to left go
       {std::pair{"\u2068", ""},
        {"\u2069", ""},
        {"&lt;", "<"},
        {"&gt;", ">"},
        {"&quot;", "\""},
        {"&#39;", "'"},
        {"&amp;", "&"}}) {
    const std::string_view entity = from;
    for (std::size_t at = 0; (at = plain.find(entity, at)) != std::string::npos; ++at) {
      plain.replace(at, entity.size(), to);
    }
  }
  return plain;
}

/// The charts in a report's text, which they refer to.
std::vector<PlottedChart> charts_in(std::string_view html) {
  std::vector<PlottedChart> charts;
  for (std::size_t at = 0; (at = html.find("<svg ", at)) != std::string_view::npos;) {
    const std::string_view rest = html.substr(at);
    constexpr std::string_view kEnd = "</svg>";
    const std::size_t end = rest.find(kEnd), tag = rest.find('>');
    if (end == std::string_view::npos) break;
    const std::string_view name = between(rest.substr(0, tag), "data-chart=\"", "\"");
    const bool again = std::any_of(charts.begin(), charts.end(),
                                   [&](const PlottedChart& chart) { return chart.name == name; });
    if (tag < end && is_chart_name(name) && !again) {
      const std::string_view svg = rest.substr(0, end + kEnd.size());
      charts.push_back({std::string(name),
                        unescaped(between(between(svg, "<title", "/title>"), ">", "<")), svg});
      at += svg.size();
    } else {
      ++at;
    }
  }
  return charts;
}

/// Those with the names, or all; each once, in the order of the report.
std::vector<PlottedChart> wanted(const std::vector<PlottedChart>& charts,
                                 const PlotOptions& options) {
  if (options.names.empty()) return charts;
  std::vector<std::string> known;
  for (const PlottedChart& chart : charts) known.push_back(chart.name);
  Diagnostics diagnostics;
  for (const std::string& name : options.names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string meant = did_you_mean(name, known);
    diagnostics.error({options.report},
                      "has no chart '" + name + "'" +
                          (meant.empty() ? "; --list prints the names of its charts" : meant));
  }
  print_or_throw(diagnostics);
  std::vector<PlottedChart> chosen;
  for (const PlottedChart& chart : charts) {
    const auto& names = options.names;
    if (std::find(names.begin(), names.end(), chart.name) != names.end()) chosen.push_back(chart);
  }
  return chosen;
}

}  // namespace

int plot(const PlotOptions& options) {
  if (options.output.empty() && !options.list) {
    throw InputError("--output is required: the folder for the SVG files; or --list");
  }
  const std::string html = detail::read_text_file(options.report);
  if (html.find("<meta name=\"generator\" content=\"kinecal") == std::string::npos) {
    throw InputError(options.report +
                     ": is not an HTML report of kinecal; 'kinecal calibrate --report out.html' "
                     "writes one");
  }
  const std::vector<PlottedChart> charts = wanted(charts_in(html), options);
  if (charts.empty()) throw InputError(options.report + ": holds no charts");
  if (options.list) {
    std::size_t width = 0;
    for (const PlottedChart& chart : charts) width = std::max(width, chart.name.size());
    for (const PlottedChart& chart : charts) {
      say("{:<{}}  {}\n", chart.name, width, chart.title);
    }
    return kDone;
  }
  std::vector<OutputFile> files;
  for (const PlottedChart& chart : charts) {
    files.push_back({chart.name + ".svg", stand_alone(chart.svg, options.width) + "\n"});
    check_output((std::filesystem::path(options.output) / files.back().name).string(),
                 {options.report}, options.force);
  }
  OutputFolder folder(options.output);
  folder.write(files, options.force ? Existing::replaced : Existing::kept);
  for (const OutputFile& file : files) {
    say("wrote {}\n", (folder.path() / file.name).string());
  }
  return kDone;
}

}  // namespace kinecal::cli
