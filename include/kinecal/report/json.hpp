// The report as JSON, for programs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/report/findings.hpp"

namespace kinecal {

/// The whole report.  Costs are 1/2 sum of squares; rms is per residual component; mean, median and
/// max are of the features' norms.  Units are metres, radians and pixels; `sigma` of a parameter is
/// one standard deviation, null if undetermined.  `covariance` is of all parameters, the lower
/// triangle row by row, zero along the combinations of `undetermined`; `poses` are joint positions.
/// Source: schema/report.schema.json beside this header documents every key
[[nodiscard]] std::string json_report(const Findings& findings);

}  // namespace kinecal
