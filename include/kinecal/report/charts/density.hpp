// Densities of distances on a logarithmic axis.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "kinecal/report/svg.hpp"

namespace kinecal::detail {

/// Number of places along an axis at which a density is drawn.
inline constexpr int kDensityBins = 120;

/// Density of values over an axis, in equal steps along it; sums to one.
/// Source: kernel density estimate with the width of Silverman's rule.
[[nodiscard]] std::array<double, kDensityBins> density_of(const std::vector<double>& values,
                                                          const Axis& x);

/// A density as an area above a line, with a tick at the median.
/// @param values  sorted
/// @param base    y of the line
/// @param height  of a density of one
void draw_density(Drawing& drawing, const std::array<double, kDensityBins>& density,
                  const std::vector<double>& values, const Axis& x, double base, double height,
                  bool is_before);

}  // namespace kinecal::detail
