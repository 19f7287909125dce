// How well held-out samples fit.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// Bars for each block: root mean square distance before, of the samples in the fit, and of samples
/// held out of it.
[[nodiscard]] std::vector<Chart> held_out_charts(const ReportData& data);

}  // namespace kinecal
