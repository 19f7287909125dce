// Errors over the distance from a depth camera.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each block with depths: the signed error of one component, or else the distance, over the depth,
/// with a running median.
[[nodiscard]] std::vector<Chart> depth_charts(const ReportData& data);

}  // namespace kinecal
