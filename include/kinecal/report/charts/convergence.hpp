// Charts of the solver's convergence.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// Cost after each iteration, logarithmic, all steps in one chart.  A curve that starts again is
/// another run: with another loss, or the next step.
[[nodiscard]] std::vector<Chart> convergence_charts(const ReportData& data);

/// For each step with several starts: how many solves reached each minimum, and which one was
/// taken.
[[nodiscard]] std::vector<Chart> start_charts(const ReportData& data);

}  // namespace kinecal
