// Drawing legends.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/svg_legend.hpp"

#include "kinecal/report/svg_text.hpp"

namespace kinecal::detail {

inline void draw_swatch(Drawing& drawing, const LegendEntry& entry, ChartPoint middle) {
  const auto [x, y] = middle;
  switch (entry.swatch) {
    case Swatch::square:
      drawing.rectangle({x - 5.0, y - 5.0}, 10.0, 10.0, entry.classes);
      break;
    case Swatch::line:
      drawing.line({x - 10.0, y}, {x + 10.0, y}, entry.classes);
      break;
    case Swatch::dot:
      drawing.circle({x, y}, 3.5, entry.classes);
      break;
    case Swatch::ring:
      drawing.circle({x, y}, 4.5, entry.classes);
      break;
    case Swatch::cross: {
      std::string cross;
      append_cross(cross, middle);
      drawing.path(cross, entry.classes);
      break;
    }
  }
}

double draw_legend(Drawing& drawing, const std::vector<LegendEntry>& entries, double top,
                   double left, double right) {
  constexpr double kLine = 18.0, kGap = 14.0;
  double x = left, y = top;
  for (const LegendEntry& entry : entries) {
    const double swatch = entry.swatch == Swatch::line ? 26.0 : 16.0;
    const double width = swatch + kSmallFont * text_width(entry.text);
    if (x > left && x + width > right) {
      x = left;
      y += kLine;
    }
    draw_swatch(drawing, entry, {x + 0.5 * swatch - 3.0, y + 9.0});
    drawing.text({x + swatch, y + 13.0}, entry.text, "small");
    x += width + kGap;
  }
  return entries.empty() ? top : y + kLine;
}

}  // namespace kinecal::detail
