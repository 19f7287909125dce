// The style of the charts: one style sheet for a page, or for a chart in its own file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kinecal {

/// CSS rules for everything in an svg of class "chart".  Colours are the page's variables --before,
/// --after, --ink, --faint, --grid, --bad, --good, --sigma, --care, --minus and --plus; without
/// them, those of a light page.
[[nodiscard]] std::string chart_style();

/// A chart as a file: the svg with an XML declaration, this style with fixed colours, and a white
/// background.
/// @param svg    that of a Chart
/// @param width  on paper, millimetres
[[nodiscard]] std::string stand_alone(std::string_view svg, double width = 160.0);

}  // namespace kinecal
