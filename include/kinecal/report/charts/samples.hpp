// Residuals of samples in the order of capture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// For each block: distance of each feature over its sample's number.  The worst feature of a
/// sample stands out; samples that do not fit are red, those left out grey.  Marks have
/// data-sample, the sample's number.  Lines: one and three times the distance expected from noise.
[[nodiscard]] std::vector<Chart> sample_charts(const ReportData& data);

}  // namespace kinecal
