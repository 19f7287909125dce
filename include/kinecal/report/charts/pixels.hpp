// Residuals in a camera's image; lens errors show as a pattern.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each block in pixels: an arrow for each feature, from the observed pixel towards the
/// predicted one, enlarged by the factor in the legend.
[[nodiscard]] std::vector<Chart> pixel_charts(const ReportData& data);

}  // namespace kinecal
