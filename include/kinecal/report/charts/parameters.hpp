// Calibrated parameters with their uncertainty.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each unit, degrees, millimetres, per cent and pixels: the change of each parameter, with
/// 1.96 standard deviations to either side.  Insignificant parameters are faint; undetermined ones
/// have a hatched row.  Bars beyond the axis end in an arrow.
/// @param change  the meaning of the numbers, as the start of a caption
[[nodiscard]] std::vector<Chart> parameter_charts(
    const ReportData& data, const std::string& change = "What the calibration added");

}  // namespace kinecal
