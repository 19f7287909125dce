// Axes of charts.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/svg_axis.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "kinecal/report/svg_text.hpp"

namespace kinecal::detail {

Axis::Axis(double low, double high, double from, double to, bool logarithmic)
    : low_(low), high_(high), from_(from), to_(to), logarithmic_(logarithmic) {}

double round_step(double range, int most) {
  const double rough = range / std::max(1, most);
  const double decade = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= 0.999 * rough) return factor * decade;
  }
  return 10.0 * decade;
}

/// A finite range that is not empty.
[[nodiscard]] inline std::pair<double, double> usable_range(double low, double high) {
  constexpr double kMost = 1e100;
  if (!std::isfinite(low)) low = std::isfinite(high) ? high : 0.0;
  if (!std::isfinite(high)) high = low;
  low = std::clamp(low, -kMost, kMost);
  high = std::clamp(high, -kMost, kMost);
  if (low > high) std::swap(low, high);
  const double size = std::max(std::abs(low), std::abs(high));
  if (high - low > 1e-9 * size) return {low, high};
  const double around = size > 0.0 ? 0.1 * size : 1.0;
  return {low - around, high + around};
}

Axis Axis::exact(double low, double high, double from, double to) {
  std::tie(low, high) = usable_range(low, high);
  return {low, high, from, to, false};
}

Axis Axis::linear(double low, double high, double from, double to) {
  std::tie(low, high) = usable_range(low, high);
  constexpr int kSteps = 8;
  const double step = round_step(high - low, kSteps);
  constexpr double kRounding = 1e-9;  // of a step: 0.3 is three steps of 0.1
  return {step * std::floor(low / step + kRounding), step * std::ceil(high / step - kRounding),
          from, to, false};
}

Axis Axis::logarithmic(double low, double high, double from, double to) {
  if (!(high > 0.0) || !std::isfinite(high)) high = 1.0;
  if (!(low > 0.0) || !std::isfinite(low) || low > high) low = 0.1 * high;
  high = std::clamp(high, 1e-100, 1e100);
  low = std::clamp(low, 1e-12 * high, high);
  if (high < 10.0 * low) {  // less than a decade has too few ticks
    const double middle = std::sqrt(low * high);
    low = middle / std::sqrt(10.0);
    high = middle * std::sqrt(10.0);
  }
  return {low, high, from, to, true};
}

double Axis::at(double value) const {
  if (std::isnan(value)) return from_;
  value = std::clamp(value, low_, high_);
  const double share = logarithmic_ ? std::log(value / low_) / std::log(high_ / low_)
                                    : (value - low_) / (high_ - low_);
  return from_ + share * (to_ - from_);
}

double Axis::value(double coordinate) const {
  const double share = (coordinate - from_) / (to_ - from_);
  return logarithmic_ ? low_ * std::pow(high_ / low_, share) : low_ + share * (high_ - low_);
}

/// "0.02", "500", "10⁴", "2·10⁻⁵".
[[nodiscard]] inline std::string decade_label(int digit, int decade) {
  if (decade >= -3 && decade < 4) return figure(digit * std::pow(10.0, decade));
  static constexpr const char* kSmall[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string label = digit == 1 ? "10" : std::to_string(digit) + "·10";
  if (decade < 0) label += "⁻";
  for (const char c : std::to_string(std::abs(decade))) label += kSmall[c - '0'];
  return label;
}

std::vector<Tick> Axis::ticks(int most) const {
  std::vector<Tick> ticks;
  if (!logarithmic_) {
    const double step = round_step(high_ - low_, most);
    const double first = std::ceil(low_ / step - 1e-6), last = std::floor(high_ / step + 1e-6);
    for (int i = 0; i <= static_cast<int>(last - first); ++i) {
      const double value = (first + i) * step;
      ticks.push_back({value, figure(value, 6)});
    }
    return ticks;
  }
  const double decades = std::log10(high_ / low_);
  const double every = std::max(1.0, std::ceil(decades / most));  // decades with a label
  const int first = static_cast<int>(std::floor(std::log10(low_)));
  const int last = static_cast<int>(std::floor(std::log10(high_) + 1e-9));
  for (int decade = first; decade <= last; ++decade) {
    for (int digit = 1; digit < 10; ++digit) {
      const double value = digit * std::pow(10.0, decade);
      if (value < low_ * (1.0 - 1e-9) || value > high_ * (1.0 + 1e-9)) continue;
      const bool named = decades < 1.7 ? digit == 1 || digit == 2 || digit == 5
                                       : digit == 1 && decade % static_cast<int>(every) == 0;
      if (named || decades < 5.0)
        ticks.push_back({value, named ? decade_label(digit, decade) : ""});
    }
  }
  return ticks;
}

}  // namespace kinecal::detail
