// A chart of a search: what each parameter bought on poses that were held out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// Error on held-out poses over the number of free parameters, with its standard error as bars, the error of
/// the fit, the chosen set, and what was tried after it.  None if there was no search.
[[nodiscard]] std::vector<Chart> search_charts(const ReportData& data);

}  // namespace kinecal
