// Residuals over the distance from the middle of a camera's image.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each block in pixels: the radial and the tangential part of residuals over the distance from the
/// middle of the image, with running medians.
[[nodiscard]] std::vector<Chart> radial_charts(const ReportData& data);

}  // namespace kinecal
