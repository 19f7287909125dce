// Charts as XML, and the values that their marks stand for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <pugixml.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal::test {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A chart that was parsed.
class SvgChart {
 public:
  explicit SvgChart(const std::string& svg) {
    const auto parsed = xml_.load_buffer(svg.data(), svg.size());
    EXPECT_TRUE(parsed) << parsed.description() << " at " << svg.substr(parsed.offset, 60);
  }
  explicit SvgChart(const Chart& chart) : SvgChart(chart.svg) {}

  [[nodiscard]] pugi::xml_node root() const { return xml_.child("svg"); }
  /// All that an XPath selects, such as "//circle[@class='after']".
  [[nodiscard]] std::vector<pugi::xml_node> all(const char* path) const {
    std::vector<pugi::xml_node> nodes;
    for (const pugi::xpath_node& node : xml_.select_nodes(path)) nodes.push_back(node.node());
    return nodes;
  }
  [[nodiscard]] std::string text(const char* path) const {
    return xml_.select_node(path).node().text().get();
  }
  /// Value at a coordinate, by the labels of the ticks.
  /// @param axis  'x' or 'y'
  [[nodiscard]] double value(char axis, double coordinate, bool logarithmic = false) const {
    const std::string path = std::string("//text[@class='tick' and @text-anchor='") +
                             (axis == 'x' ? "middle" : "end") + "']";
    std::vector<std::array<double, 2>> ticks;  // coordinate, value
    for (const pugi::xml_node& tick : all(path.c_str())) {
      std::string label = tick.text().get();
      if (label.starts_with("\u2212")) label.replace(0, 3, "-");
      const double at = tick.attribute(axis == 'x' ? "x" : "y").as_double() - (axis == 'x' ? 0 : 4);
      ticks.push_back({at, std::atof(label.c_str())});
    }
    if (ticks.size() < 2) return std::nan("");
    const auto f = [&](double v) { return logarithmic ? std::log10(v) : v; };
    const auto& [from, low] = ticks.front();
    const auto& [to, high] = ticks.back();
    const double at = f(low) + (coordinate - from) / (to - from) * (f(high) - f(low));
    return logarithmic ? std::pow(10.0, at) : at;
  }

 private:
  pugi::xml_document xml_;
};

/// The numbers in the data of a path.
inline std::vector<double> numbers_of(const pugi::xml_node& path) {
  std::vector<double> numbers;
  const std::string data = path.attribute("d").value();
  for (const char* at = data.c_str(); *at != '\0';) {
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end == at) {
      ++at;
    } else {
      numbers.push_back(number);
      at = end;
    }
  }
  return numbers;
}

/// The chart of a name.
inline const Chart& chart_named(const std::vector<Chart>& charts, const std::string& name) {
  for (const Chart& chart : charts) {
    if (chart.name == name) return chart;
  }
  throw std::runtime_error("no chart " + name);
}

}  // namespace kinecal::test
