// Writing charts as SVG.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "kinecal/report/svg_text.hpp"

namespace kinecal::detail {

Drawing::Drawing(std::string name, std::string_view title, double height, double width)
    : name_(std::move(name)), title_(svg_escaped(title)), width_(width), height_(height) {}

[[nodiscard]] inline std::string pair_text(ChartPoint place) {
  std::string text = coordinate(place[0]);
  text += ' ';
  append_coordinate(text, place[1]);
  return text;
}

void append_dot(std::string& data, ChartPoint place) {
  data += 'M';
  append_coordinate(data, place[0]);
  data += ' ';
  append_coordinate(data, place[1]);
  data += "h0";  // round ends make it a dot
}

void append_cross(std::string& data, ChartPoint place) {
  constexpr double kHalf = 3.5;
  const auto [x, y] = place;
  data += 'M' + pair_text({x - kHalf, y - kHalf}) + 'L' + pair_text({x + kHalf, y + kHalf}) + 'M' +
          pair_text({x + kHalf, y - kHalf}) + 'L' + pair_text({x - kHalf, y + kHalf});
}

/// Ends a mark whose tag is still open.
void Drawing::close(int sample, std::string_view title, const char* tag) {
  if (sample > 0) marks_ += fmt::format(R"( data-sample="{}")", sample);
  if (title.empty()) {
    marks_ += "/>\n";
  } else {
    marks_ += fmt::format("><title>{}</title></{}>\n", svg_escaped(title), tag);
  }
}

void Drawing::line(ChartPoint a, ChartPoint b, const char* classes) {
  path("M" + pair_text(a) + "L" + pair_text(b), classes);
}

void Drawing::rectangle(ChartPoint corner, double width, double height, const char* classes,
                        std::string_view title, int sample) {
  marks_ += fmt::format(R"(<rect class="{}" x="{}" y="{}" width="{}" height="{}")", classes,
                        coordinate(corner[0]), coordinate(corner[1]),
                        coordinate(std::max(0.0, width)), coordinate(std::max(0.0, height)));
  close(sample, title, "rect");
}

void Drawing::circle(ChartPoint center, double radius, const char* classes, int sample,
                     std::string_view title) {
  marks_ += fmt::format(R"(<circle class="{}" cx="{}" cy="{}" r="{}")", classes,
                        coordinate(center[0]), coordinate(center[1]), coordinate(radius));
  close(sample, title, "circle");
}

void Drawing::curve(std::span<const ChartPoint> places, const char* classes) {
  std::string data;
  bool pen_down = false;
  for (const ChartPoint& place : places) {
    const bool finite = std::isfinite(place[0]) && std::isfinite(place[1]);
    if (finite) data += (pen_down ? 'L' : 'M') + pair_text(place);
    pen_down = finite;
  }
  if (!data.empty()) path(data, classes);
}

void Drawing::area(std::span<const ChartPoint> places, const char* classes) {
  std::string data;
  for (const ChartPoint& place : places) data += (data.empty() ? 'M' : 'L') + pair_text(place);
  if (!data.empty()) path(data + "z", classes);
}

void Drawing::path(std::string_view data, const char* classes, int sample, std::string_view title) {
  marks_ += "<path";
  if (*classes != '\0') marks_ += fmt::format(R"( class="{}")", classes);
  marks_ += R"( d=")";
  marks_ += data;
  marks_ += '"';
  close(sample, title, "path");
}

void Drawing::text(ChartPoint place, std::string_view text, const char* classes, Anchor anchor,
                   std::string_view title, double turned) {
  marks_ += fmt::format(R"(<text x="{}" y="{}")", coordinate(place[0]), coordinate(place[1]));
  if (*classes != '\0') marks_ += fmt::format(R"( class="{}")", classes);
  if (anchor != Anchor::start) {
    marks_ += anchor == Anchor::middle ? R"( text-anchor="middle")" : R"( text-anchor="end")";
  }
  if (turned != 0.0) {
    marks_ += fmt::format(R"x( transform="rotate({} {})")x", coordinate(turned), pair_text(place));
  }
  marks_ += '>' + svg_escaped(text);
  if (!title.empty()) marks_ += "<title>" + svg_escaped(title) + "</title>";
  marks_ += "</text>\n";
}

void Drawing::name(ChartPoint place, std::string_view name, double width, const char* classes,
                   Anchor anchor, double turned) {
  constexpr std::size_t kLongest = 60;
  const double font = std::string_view(classes).starts_with("small") ? kSmallFont : kFontSize;
  const double bold = std::string_view(classes).starts_with("strong") ? 1.18 : 1.0;
  std::string shown = shortened(name, kLongest);
  for (std::size_t most = kLongest; most > 4 && bold * font * text_width(shown) > width;) {
    shown = shortened(name, --most);
  }
  const bool whole = shown.find("…") == std::string::npos;
  text(place, shown, classes, anchor, whole ? std::string_view() : name, turned);
}

void Drawing::open_group(const char* classes) {
  marks_ += fmt::format("<g class=\"{}\">\n", classes);
}

void Drawing::close_group() {
  marks_ += "</g>\n";
}

void Drawing::hatching(ChartPoint corner, double width, double height, std::string_view title) {
  has_hatching_ = true;
  marks_ += fmt::format(R"x(<rect x="{}" y="{}" width="{}" height="{}" fill="url(#{}-hatch)")x",
                        coordinate(corner[0]), coordinate(corner[1]), coordinate(width),
                        coordinate(height), name_);
  close(0, title, "rect");
}

void Drawing::axis_x(const PlotArea& area, const Axis& x, std::string_view name, bool whole) {
  constexpr double kBelow = 16.0, kApart = 4.0;
  double labelled_to = -HUGE_VAL;
  for (const Tick& tick : x.ticks()) {
    if (whole && std::abs(tick.value - std::round(tick.value)) > 1e-6) continue;
    const double at = x.at(tick.value), half = 0.5 * kSmallFont * text_width(tick.label);
    const bool labelled = !tick.label.empty() && at - half >= labelled_to + kApart;
    line({at, area.top}, {at, area.bottom}, labelled ? "grid" : "grid minor");
    if (!labelled) continue;
    text({at, area.bottom + kBelow}, tick.label, "tick", Anchor::middle);
    labelled_to = at + half;
  }
  line({area.left, area.bottom}, {area.right, area.bottom}, "axis");
  text({area.right, area.bottom + 2.0 * kBelow + 1.0}, name, "name", Anchor::end);
}

void Drawing::axis_y(const PlotArea& area, const Axis& y, std::string_view name) {
  const int most = std::max(3, static_cast<int>((area.bottom - area.top) / 36.0));
  constexpr double kLine = 12.0;
  double last = HUGE_VAL;
  for (const Tick& tick : y.ticks(most)) {
    const double at = y.at(tick.value);
    const bool labelled = !tick.label.empty() && std::abs(last - at) >= kLine;
    line({area.left, at}, {area.right, at}, labelled ? "grid" : "grid minor");
    if (!labelled) continue;
    text({area.left - 5.0, at + 4.0}, tick.label, "tick", Anchor::end);
    last = at;
  }
  text({2.0, area.top - 9.0}, name, "name");
}

void Drawing::axes(const PlotArea& area, const Axis& x, const Axis& y, std::string_view x_name,
                   std::string_view y_name) {
  axis_y(area, y, y_name);
  axis_x(area, x, x_name);
}

std::string Drawing::str(std::string_view description) const {
  std::string hatch;
  if (has_hatching_) {
    hatch = fmt::format(
        R"(<defs><pattern id="{}-hatch" width="6" height="6" patternUnits="userSpaceOnUse">)"
        "<path class=\"hatch\" d=\"M-1 7L7 -1M-1 1L1 -1M5 7L7 5\"/></pattern></defs>\n",
        name_);
  }
  return fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-labelledby="{0}-title {0}-desc" )"
      R"(class="chart" data-chart="{0}" viewBox="0 0 {1} {2}">)"
      "\n<title id=\"{0}-title\">{3}</title>\n<desc id=\"{0}-desc\">{4}</desc>\n{5}{6}</svg>\n",
      name_, coordinate(width_), coordinate(height_), title_, svg_escaped(description), hatch,
      marks_);
}

}  // namespace kinecal::detail
