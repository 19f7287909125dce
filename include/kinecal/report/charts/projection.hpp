// How well cameras are known over their images.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each camera: standard deviation of a pixel over the image, and the difference between halves of the samples.
[[nodiscard]] std::vector<Chart> projection_charts(const ReportData& data);

}  // namespace kinecal
