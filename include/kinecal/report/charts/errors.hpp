// Distributions of errors before and after the calibration.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// Distributions of the features' distances at the initial values and at the result, on one
/// logarithmic axis for all blocks of one unit.  Lines: distance that the noise, estimated and given,
/// makes one expect, sigma sqrt(components).  Samples that were left out are not in them.
[[nodiscard]] std::vector<Chart> error_charts(const ReportData& data);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/charts/errors.ipp"
#endif
