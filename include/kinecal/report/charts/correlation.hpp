// A chart of the correlations between parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// The lower triangle of the correlation matrix, in the order of the data.  Of more than 60
/// parameters, those with the largest correlations.
[[nodiscard]] std::vector<Chart> correlation_charts(const ReportData& data);

}  // namespace kinecal
