// The look of the charts.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/chart_style.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace kinecal {

std::string chart_style() {
  return R"(.chart { display: block; width: 100%; max-width: 36rem; height: auto; font: 13px system-ui, "DejaVu Sans", sans-serif; }
.chart text { fill: var(--ink, #1f2328); }
.chart text.tick, .chart text.small { font-size: 12px; }
.chart text.tick, .chart text.name, .chart text.quiet { fill: var(--muted, #55616c); }
.chart text.strong { font-weight: 600; }
.chart text.figure { font-variant-numeric: tabular-nums; }
.chart text.before { fill: var(--before, #b0651d); }
.chart text.after { fill: var(--after, #1c62b9); }
.chart text.bad { fill: var(--bad, #c0262d); }
.chart text.sigma { fill: var(--sigma, #6b4fa3); }
.chart path, .chart line { fill: none; stroke: var(--ink, #1f2328); stroke-width: 1; }
.chart path.grid { stroke: var(--grid, #dfe3e8); }
.chart path.grid.minor { stroke-width: .5; }
.chart path.axis, .chart path.frame, .chart rect.frame { stroke: var(--faint, #667080); fill: none; }
.chart path.zero { stroke: var(--ink, #1f2328); stroke-width: 1.2; }
.chart path.sigma { stroke: var(--sigma, #6b4fa3); stroke-width: 1.5; stroke-dasharray: 6 3; }
.chart path.given { stroke: var(--sigma, #6b4fa3); stroke-width: 1.5; stroke-dasharray: 1.5 3; }
.chart path.before, .chart circle.ring.before { stroke: var(--before, #b0651d); }
.chart path.after, .chart circle.ring.after { stroke: var(--after, #1c62b9); }
.chart path.bad { stroke: var(--bad, #c0262d); }
.chart path.faint { stroke: var(--faint, #667080); }
.chart path.thick { stroke-width: 2.2; }
.chart path.median { stroke: var(--ink, #1f2328); stroke-width: 2; stroke-linejoin: round; }
.chart path.area { fill-opacity: .3; stroke-width: 1.4; }
.chart path.area.before, .chart rect.before, .chart circle.before { fill: var(--before, #b0651d); }
.chart path.area.after, .chart rect.after, .chart circle.after { fill: var(--after, #1c62b9); }
.chart rect.held, .chart circle.held { fill: var(--sigma, #6b4fa3); }
.chart rect.faint, .chart circle.faint { fill: var(--faint, #667080); }
.chart rect.pale { fill: var(--grid, #dfe3e8); }
.chart rect.good, .chart circle.good { fill: var(--good, #2a7d3f); }
.chart rect.bad, .chart circle.bad { fill: var(--bad, #c0262d); }
.chart circle.ring { fill: none; stroke-width: 1.6; }
.chart circle.ring.bad { stroke: var(--bad, #c0262d); fill: none; }
.chart .dots path { stroke: var(--after, #1c62b9); stroke-width: 4; stroke-linecap: round; stroke-opacity: .45; }
.chart .dots.worst path { stroke-width: 5.5; stroke-opacity: 1; }
.chart .dots.bad path { stroke: var(--bad, #c0262d); stroke-width: 5.5; stroke-opacity: .9; }
.chart .out path, .chart path.out { stroke: var(--muted, #55616c); stroke-width: 1.8; }
.chart circle.target { fill: transparent; }
.chart text.halo { paint-order: stroke; stroke: var(--card, #ffffff); stroke-width: 3px; stroke-linejoin: round; }
.chart .dots.small path { stroke-width: 3; }
.chart .arrows path { stroke: var(--after, #1c62b9); stroke-width: 1; stroke-opacity: .6; }
.chart .arrows.bad path { stroke: var(--bad, #c0262d); stroke-width: 1.6; stroke-opacity: .9; }
.chart .dots.mask path { stroke: var(--muted, #55616c); stroke-width: 5; stroke-opacity: .5; }
.chart .dots.outline path { stroke-width: 1.8; stroke-opacity: 1; }
.chart .dots.outline.before path { stroke: var(--before, #b0651d); }
.chart [data-sample] { cursor: pointer; }
.chart .hatch { stroke: var(--care, #a86a00); stroke-width: 1.2; stroke-opacity: .55; }
.chart .care { fill: var(--care, #a86a00); }
.chart path.care { fill: none; stroke: var(--care, #a86a00); }
.chart .minus { fill: var(--minus, #2166ac); }
.chart .plus { fill: var(--plus, #c2410c); }
.chart circle.minus, .chart circle.plus, .chart circle.none { stroke: var(--faint, #667080); stroke-width: .4; }
.chart .none { fill: var(--grid, #dfe3e8); }
.chart .l1 { fill-opacity: .22; }
.chart .l2 { fill-opacity: .42; }
.chart .l3 { fill-opacity: .64; }
.chart .l4 { fill-opacity: .85; }
.chart .scale1 { fill: #2c5fa8; }
.chart .scale2 { fill: #3f8fb5; }
.chart .scale3 { fill: #7fb8a6; }
.chart .scale4 { fill: #d9b44a; }
.chart .scale5 { fill: #d9632e; }
)";
}

namespace detail {
namespace {

/// The style with the colours of a light page instead of variables, which most drawing programs do
/// not support.
[[nodiscard]] std::string style_without_variables() {
  std::string style = chart_style();
  constexpr std::string_view kSize =
      "display: block; width: 100%; max-width: 36rem; height: auto; ";
  style.erase(style.find(kSize), kSize.size());  // of the page; a file has its own
  std::string plain;
  std::size_t at = 0;
  for (std::size_t use; (use = style.find("var(", at)) != std::string::npos;) {
    const std::size_t value = style.find(", ", use) + 2, end = style.find(')', use);
    plain += style.substr(at, use - at) + style.substr(value, end - value);
    at = end + 1;
  }
  return plain + style.substr(at);
}

/// " width=\"85mm\" height=\"51mm\"" of an svg's first tag.
[[nodiscard]] std::string physical_size(std::string_view tag, double width) {
  constexpr std::string_view kBox = "viewBox=\"0 0 ";
  const std::size_t box = tag.find(kBox);
  double across = 0.0, down = 0.0;
  if (box != std::string_view::npos) {
    const std::string numbers(tag.substr(box + kBox.size()));
    char* end = nullptr;
    across = std::strtod(numbers.c_str(), &end);
    down = std::strtod(end, nullptr);
  }
  if (!(across > 0.0 && down > 0.0)) return "";
  return fmt::format(R"( width="{:.6g}mm" height="{:.6g}mm")", width, width * down / across);
}

}  // namespace
}  // namespace detail

std::string stand_alone(std::string_view svg, double width) {
  const std::size_t tag = svg.find('>');
  if (tag == std::string_view::npos) return {};
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  text += svg.substr(0, tag);
  text += detail::physical_size(svg.substr(0, tag), width);
  text += ">\n<style>\n" + detail::style_without_variables() + "</style>\n";
  text += R"(<rect width="100%" height="100%" fill="white"/>)";
  text += svg.substr(tag + 1);
  return text;
}

}  // namespace kinecal
