// Residuals of features: which of a board's corners or of a gripper's LEDs fits worse than others.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each block with several features: a box from quartile to quartile with the median for each
/// place or id, and dots.  Of more than 48 features, those with the largest medians.
[[nodiscard]] std::vector<Chart> feature_charts(const ReportData& data);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/charts/features.ipp"
#endif
