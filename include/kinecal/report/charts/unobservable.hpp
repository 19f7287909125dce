// Unobservable parameter combinations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// Combinations of parameters that change no residual: a signed bar for each factor.
[[nodiscard]] std::vector<Chart> unobservable_charts(const ReportData& data);

}  // namespace kinecal
