// Which camera saw which pose.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// A row for each camera and a column for each sample: coloured where error blocks compare what the camera saw, by its
/// distance in units of what noise explains.  Marks have data-sample, the sample's number.  Empty of a single camera.
[[nodiscard]] std::vector<Chart> camera_charts(const ReportData& data);

}  // namespace kinecal
