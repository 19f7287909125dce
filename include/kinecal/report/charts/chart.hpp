// A chart of a report, and what all charts share: units, names, and the selection of marks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/report/report_data.hpp"

namespace kinecal {

/// A chart.
struct Chart {
  std::string section;  ///< of the report: "errors", "residuals", "parameters", "convergence", ...
  std::string name;     ///< data-chart of the svg and name of its file: "samples-hand_eye"
  std::string title;    ///< plain text
  std::string caption;  ///< how to read it, a sentence or two, plain text; may be empty
  std::string svg;      ///< "<svg ...>...</svg>"; needs chart_style()
};

namespace detail {

/// Most marks in a chart; beyond that, the worst and an even selection of the others are drawn.
inline constexpr std::size_t kMostMarks = 2000;

/// Factor to the displayed unit: 1000 for "m", 180/pi for "rad", 1 for others.
[[nodiscard]] double people_factor(const std::string& unit);
/// "mm", "°" or "px"; empty for "1".
[[nodiscard]] std::string people_unit(const std::string& unit);
/// "12.3 mm" of a value in the data's unit.
[[nodiscard]] std::string with_unit(double value, const std::string& unit);
/// "distance, mm", or the text alone if there is no unit.
[[nodiscard]] std::string axis_name(const std::string& what, const std::string& unit);

/// Units of residuals, in the order of the blocks.
[[nodiscard]] std::vector<std::string> units_of(const ReportData& data);
/// "errors-mm"; only the name if there is no unit.
[[nodiscard]] std::string name_with_unit(const char* name, const std::string& unit);

/// Calls a function for each block, in their order.
/// @param visit  slug: unique name of the block, for charts and files
void for_each_block(
    const ReportData& data,
    const std::function<void(const ReportedBlock& block, const std::string& slug)>& visit);
/// Draws a chart of a block; one without an svg is left out.
/// @param slug  unique name of the block, for charts and files
using DrawBlock = std::function<Chart(const ReportedBlock& block, const std::string& slug)>;
/// The charts of blocks, in their order.
[[nodiscard]] std::vector<Chart> charts_of_blocks(const ReportData& data, const DrawBlock& draw);

/// Number of a feature's sample, from 1, in the order of the files.
[[nodiscard]] int sample_number(const ReportData& data, const ReportedFeature& feature);
/// The feature's sample; one without faults if the data has none.
[[nodiscard]] const ReportedSample& sample_of(const ReportData& data,
                                              const ReportedFeature& feature);
/// "sample 12, feature 3: 4.56 mm".
[[nodiscard]] std::string feature_text(const ReportData& data, const ReportedBlock& block,
                                       const ReportedFeature& feature);

/// Selects marks to draw, in order: the worst ones and an even selection of the others.
/// @param sizes  larger is worse; skips values that are not finite
[[nodiscard]] std::vector<std::size_t> chosen_marks(std::span<const double> sizes,
                                                    std::size_t most = kMostMarks);
/// " 2000 of 200 000 features are shown, the worst among them.", or empty if all are.
[[nodiscard]] std::string chosen_text(std::size_t shown, std::size_t all, const char* what);

/// The finite values, ascending.
[[nodiscard]] std::vector<double> sorted_finite(std::span<const double> values);
/// Quantile of sorted values, interpolated; NaN if absent.
/// @param share  0 to 1
[[nodiscard]] double quantile(std::span<const double> sorted, double share);

/// Expected distance of a feature from noise alone: sigma sqrt(components).
[[nodiscard]] double expected_distance(const ReportedBlock& block, double sigma);

}  // namespace detail

}  // namespace kinecal
