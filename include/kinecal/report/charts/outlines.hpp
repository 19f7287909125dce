// The outline of the robot over its masks, before and after.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each block of masks (camera2d_to_mesh) the worst sample and the median one, in the image: the edges of the mask that
/// the fit uses, and the points of the robot's outline that belong to them.
[[nodiscard]] std::vector<Chart> outline_charts(const ReportData& data);

}  // namespace kinecal
