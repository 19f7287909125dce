// Distributions of errors before and after the calibration.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// Distributions of the features' distances at the initial values and at the result, on one
/// logarithmic axis for all blocks of the same unit.  Lines: distances expected from the noise,
/// estimated and given, sigma sqrt(components).  Samples left out are not included.
[[nodiscard]] std::vector<Chart> error_charts(const ReportData& data);

}  // namespace kinecal
