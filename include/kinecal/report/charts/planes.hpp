// Errors over the floor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each block that compares with a plane: the error at each point, seen from above.
[[nodiscard]] std::vector<Chart> plane_charts(const ReportData& data);

}  // namespace kinecal
