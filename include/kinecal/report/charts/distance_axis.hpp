// The axes of distances and of samples, and the distances expected from noise.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"
#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"

namespace kinecal::detail {

/// Distances of a block's features at the result, in the displayed unit; some may not be finite.
[[nodiscard]] std::vector<double> distances_of(const ReportedBlock& block);

/// The same, NaN for samples that were left out.
[[nodiscard]] std::vector<double> used_distances(const ReportData& data,
                                                 const ReportedBlock& block);

/// An axis for these distances: linear from zero, or logarithmic if some are so far off that all
/// others would be flat.
/// @param sorted  finite distances, ascending
[[nodiscard]] Axis distance_axis(const ReportedBlock& block, const std::vector<double>& sorted,
                                 double bottom, double top);

/// The numbers of all samples, and some room at both ends.
[[nodiscard]] Axis samples_axis(const ReportData& data, const ReportedBlock& block,
                                const PlotArea& area);

/// Lines at one and three times the distance expected from noise, if they are within the axis.
void draw_noise_lines(Drawing& drawing, const PlotArea& area, const Axis& y,
                      const ReportedBlock& block);

/// The entries of a legend for them.
[[nodiscard]] std::vector<LegendEntry> noise_entries(const Axis& y, const ReportedBlock& block);

}  // namespace kinecal::detail
