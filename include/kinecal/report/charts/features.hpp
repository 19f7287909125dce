// Residuals by feature: which corner of a board or LED of a gripper fits worse than others.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each block with several features: for each place or id, a box from quartile to quartile with
/// the median, and dots.  Of more than 48 features, those with the largest medians.
[[nodiscard]] std::vector<Chart> feature_charts(const ReportData& data);

}  // namespace kinecal
