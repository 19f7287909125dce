// Uncertainty of a position over the workspace.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// Standard deviation of the position over the workspace, from above and from the side.
[[nodiscard]] std::vector<Chart> workspace_charts(const ReportData& data);

}  // namespace kinecal
