// Calibrated parameters with their uncertainty.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each unit, degrees, millimetres, per cent and pixels: what was added to each parameter, with 1.96
/// standard deviations to either side.  Parameters that are not significant are faint; those that are
/// not determined have a hatched row.  What is beyond the axis ends in an arrow.
/// @param change  what the numbers are, as a caption begins
[[nodiscard]] std::vector<Chart> parameter_charts(
    const ReportData& data, const std::string& change = "What the calibration added");

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/charts/parameters.ipp"
#endif
