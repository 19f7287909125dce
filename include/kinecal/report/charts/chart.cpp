// What all charts share.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "kinecal/report/svg_text.hpp"

namespace kinecal::detail {

double people_factor(const std::string& unit) {
  return unit == "m" ? 1e3 : unit == "rad" ? 180.0 / std::numbers::pi : 1.0;
}

std::string people_unit(const std::string& unit) {
  return unit == "m" ? "mm" : unit == "rad" ? "°" : unit == "1" ? "" : unit;
}

std::string with_unit(double value, const std::string& unit) {
  const std::string name = people_unit(unit);
  return figure(people_factor(unit) * value) + (name.empty() || name == "°" ? "" : " ") + name;
}

std::string axis_name(const std::string& what, const std::string& unit) {
  const std::string name = people_unit(unit);
  return name.empty() ? what : what + ", " + name;
}

std::vector<std::string> units_of(const ReportData& data) {
  std::vector<std::string> units;
  for (const ReportedBlock& block : data.blocks) {
    if (std::find(units.begin(), units.end(), block.unit) == units.end()) {
      units.push_back(block.unit);
    }
  }
  return units;
}

std::string name_with_unit(const char* name, const std::string& unit) {
  const std::string slug = unit == "rad" ? "deg" : slug_of(people_unit(unit));
  return slug.empty() ? name : name + ("-" + slug);
}

void for_each_block(
    const ReportData& data,
    const std::function<void(const ReportedBlock& block, const std::string& slug)>& visit) {
  std::set<std::string> taken;
  for (const ReportedBlock& block : data.blocks) {
    const std::string slug = slug_of(block.name);
    std::string unique = slug.empty() ? "block" : slug;
    for (int i = 2; !taken.insert(unique).second; ++i) {
      unique = fmt::format("{}-{}", slug.empty() ? "block" : slug, i);
    }
    visit(block, unique);
  }
}

std::vector<Chart> charts_of_blocks(const ReportData& data, const DrawBlock& draw) {
  std::vector<Chart> charts;
  for_each_block(data, [&](const ReportedBlock& block, const std::string& slug) {
    Chart chart = draw(block, slug);
    if (!chart.svg.empty()) charts.push_back(std::move(chart));
  });
  return charts;
}

const ReportedSample& sample_of(const ReportData& data, const ReportedFeature& feature) {
  static const ReportedSample kUnknown = {};
  const bool known = feature.sample >= 0 && feature.sample < std::ssize(data.samples);
  return known ? data.samples[static_cast<std::size_t>(feature.sample)] : kUnknown;
}

int sample_number(const ReportData& data, const ReportedFeature& feature) {
  const int number = sample_of(data, feature).number;
  return number > 0 ? number : std::max(0, feature.sample) + 1;
}

std::string feature_text(const ReportData& data, const ReportedBlock& block,
                         const ReportedFeature& feature) {
  return fmt::format("sample {}, {}: {}", sample_number(data, feature), feature.feature.text(),
                     with_unit(feature.after, block.unit));
}

std::vector<std::size_t> chosen_marks(std::span<const double> sizes, std::size_t most) {
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (std::isfinite(sizes[i])) all.push_back(i);
  }
  if (all.size() <= most) return all;
  const std::size_t worst = most / 10, others = most - worst;
  const auto end_of_worst = all.begin() + static_cast<std::ptrdiff_t>(worst);
  std::nth_element(all.begin(), end_of_worst, all.end(), [&](std::size_t a, std::size_t b) {
    return sizes[a] != sizes[b] ? sizes[a] > sizes[b] : a < b;
  });
  std::vector<std::size_t> chosen(all.begin(), end_of_worst);
  std::sort(end_of_worst, all.end());
  for (std::size_t i = 0; i < others; ++i) {
    chosen.push_back(end_of_worst[static_cast<std::ptrdiff_t>(i * (all.size() - worst) / others)]);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

std::string chosen_text(std::size_t shown, std::size_t all, const char* what) {
  if (shown >= all) return {};
  return fmt::format(" {} of {} {} are shown, the worst among them.", count_text(shown),
                     count_text(all), what);
}

std::vector<double> sorted_finite(std::span<const double> values) {
  std::vector<double> sorted;
  sorted.reserve(values.size());
  for (const double value : values) {
    if (std::isfinite(value)) sorted.push_back(value);
  }
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

double quantile(std::span<const double> sorted, double share) {
  if (sorted.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return std::lerp(sorted[below], sorted[above], place - static_cast<double>(below));
}

double expected_distance(const ReportedBlock& block, double sigma) {
  return sigma * std::sqrt(std::max(1, block.components));
}

}  // namespace kinecal::detail
