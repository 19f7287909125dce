// Drawing combinations that are not observable.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/unobservable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Parameter names and factors.
using NamedCombination = std::vector<std::pair<std::string, double>>;

constexpr std::size_t kMostCombinations = 12, kMostFactors = 8;
constexpr double kCombinationTitle = 26.0, kFactorRow = 20.0;

/// Lines that a combination needs; one gives the number of omitted factors.
[[nodiscard]] std::size_t factor_rows(const NamedCombination& combination) {
  return std::min(combination.size(), kMostFactors + 1);
}

void draw_factor(Drawing& drawing, const std::pair<std::string, double>& part, double y,
                 double largest) {
  constexpr double kZero = 305.0, kHalf = 110.0;
  const double share = std::isfinite(part.second) ? std::abs(part.second) / largest : 0.0;
  const double length = kHalf * std::min(1.0, share);
  drawing.name({kZero - kHalf - 8.0, y + 4.0}, part.first, kZero - kHalf - 12.0, "small",
               Anchor::end);
  drawing.rectangle({part.second < 0.0 ? kZero - length : kZero, y - 6.0}, length, 12.0,
                    part.second < 0.0 ? "minus" : "plus");
  drawing.line({kZero, y - 10.0}, {kZero, y + 10.0}, "axis");
  drawing.text({kChartWidth - 4.0, y + 4.0},
               (part.second > 0.0 ? "+" : "") + figure(part.second, 2), "small figure",
               Anchor::end);
}

/// @returns  the combination as text
std::string draw_combination(Drawing& drawing, const NamedCombination& combination,
                             std::size_t number, double top) {
  double largest = 0.0;
  for (const auto& part : combination) {
    if (std::isfinite(part.second)) largest = std::max(largest, std::abs(part.second));
  }
  if (!(largest > 0.0)) largest = 1.0;
  drawing.text({2.0, top + 16.0}, fmt::format("combination {}", number), "strong");
  std::string words = fmt::format(" {}:", number);
  double y = top + kCombinationTitle + 0.5 * kFactorRow;
  for (std::size_t i = 0; i < std::min(combination.size(), kMostFactors); ++i) {
    draw_factor(drawing, combination[i], y, largest);
    words += fmt::format("{} {} {}", i > 0 ? "," : "", figure(combination[i].second, 2),
                         shortened(combination[i].first, 40));
    y += kFactorRow;
  }
  if (combination.size() > kMostFactors) {
    drawing.text({187.0, y + 4.0}, fmt::format("and {} more", combination.size() - kMostFactors),
                 "small quiet", Anchor::end);
  }
  return words + ".";
}

}  // namespace
}  // namespace detail

std::vector<Chart> unobservable_charts(const ReportData& data) {
  const std::size_t all = data.unobservable.size();
  const std::size_t shown = std::min(all, detail::kMostCombinations);
  if (all == 0) return {};
  Chart chart{"parameters", "unobservable", "Combinations that are not observable",
              "Moving these parameters together, in these proportions, changes no measurement.",
              ""};
  if (shown < all) chart.caption += fmt::format(" {} of {} combinations are shown.", shown, all);
  double height = 6.0;
  for (std::size_t c = 0; c < shown; ++c) {
    height += detail::kCombinationTitle +
              detail::kFactorRow * double(detail::factor_rows(data.unobservable[c]));
  }
  detail::Drawing drawing(chart.name, chart.title, height);
  std::string description = fmt::format("{} combinations are not observable.", all);
  double y = 0.0;
  for (std::size_t c = 0; c < shown; ++c) {
    description += detail::draw_combination(drawing, data.unobservable[c], c + 1, y);
    y += detail::kCombinationTitle +
         detail::kFactorRow * double(detail::factor_rows(data.unobservable[c]));
  }
  chart.svg = drawing.str(description);
  return {chart};
}

}  // namespace kinecal
