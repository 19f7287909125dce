// All charts of a report.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// All charts that the data allow, in reading order, grouped by section.  The same data give the
/// same bytes.
[[nodiscard]] std::vector<Chart> charts(const ReportData& data);

}  // namespace kinecal
