// Draws a chart as SVG: marks, texts, axes, with one title and one description for screen readers.
//
// Colours are classes only (chart_style.hpp), so a chart is light or dark as its page is.  Coordinates
// are those of the viewBox, y downwards.  That is why it is written by hand: the SVG of plotting libraries, and
// of Cairo, has fixed colours, glyphs in place of text, and no descriptions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "kinecal/report/svg_axis.hpp"

namespace kinecal::detail {

/// Width of every chart: on a phone, size 13 then appears as 10.
inline constexpr double kChartWidth = 420.0;
/// Font sizes: normal, and those of the classes "small" and "tick".
inline constexpr double kFontSize = 13.0, kSmallFont = 12.0;

/// A point of a chart: x, y.
using ChartPoint = std::array<double, 2>;

/// The position of a text relative to its place.
enum class Anchor { start, middle, end };

/// The part of a chart between its axes.
struct PlotArea {
  double left = 46.0, top = 24.0, right = kChartWidth - 10.0, bottom = 260.0;
};

/// A chart while it is drawn.
class Drawing {
 public:
  /// @param name    data-chart of the svg, and prefix of its ids
  /// @param title   plain text
  Drawing(std::string name, std::string_view title, double height, double width = kChartWidth);

  void line(ChartPoint a, ChartPoint b, const char* classes);
  void rectangle(ChartPoint corner, double width, double height, const char* classes,
                 std::string_view title = {}, int sample = 0);
  void circle(ChartPoint center, double radius, const char* classes, int sample = 0,
              std::string_view title = {});
  /// A line through places; places that are not finite interrupt it.
  void curve(std::span<const ChartPoint> places, const char* classes);
  /// A filled shape.
  void area(std::span<const ChartPoint> places, const char* classes);
  /// Any SVG path.
  /// @param sample  number of the sample that a click selects; 0: none
  void path(std::string_view data, const char* classes, int sample = 0,
            std::string_view title = {});
  /// @param title  tooltip, such as the full name; empty: none
  void text(ChartPoint place, std::string_view text, const char* classes = "",
            Anchor anchor = Anchor::start, std::string_view title = {}, double turned = 0.0);
  /// A name shortened to a width, with the full name as tooltip.
  void name(ChartPoint place, std::string_view name, double width, const char* classes = "",
            Anchor anchor = Anchor::start, double turned = 0.0);
  void open_group(const char* classes);
  void close_group();
  /// Defines the hatching, once per chart; later shapes of class "hatched" use it.
  void hatching(ChartPoint corner, double width, double height, std::string_view title);

  /// Grid, ticks and names of both axes; the name of y is above the axis.
  void axes(const PlotArea& area, const Axis& x, const Axis& y, std::string_view x_name,
            std::string_view y_name);
  /// Grid, ticks and name of one axis.
  /// @param whole  ticks at whole numbers only
  void axis_x(const PlotArea& area, const Axis& x, std::string_view name, bool whole = false);
  void axis_y(const PlotArea& area, const Axis& y, std::string_view name);

  /// The whole svg.
  /// @param description  a sentence or two with the main figures, plain text
  [[nodiscard]] std::string str(std::string_view description) const;

 private:
  void close(int sample, std::string_view title, const char* tag);

  std::string name_, title_, marks_;
  double width_, height_;
  bool has_hatching_ = false;
};

/// Marks of a sample as one path: dots where its features are.
void append_dot(std::string& data, ChartPoint place);
/// The same as a cross.
void append_cross(std::string& data, ChartPoint place);

}  // namespace kinecal::detail
