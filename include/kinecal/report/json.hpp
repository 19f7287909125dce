// The report as JSON, for programs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "kinecal/files/results/output_file.hpp"
#include "kinecal/report/findings.hpp"

namespace kinecal {

/// Of report.json.  It grows when a key changes its meaning; a report without `format` is of the first, whose `rms`
/// was of a residual's components.
inline constexpr int kReportFormat = 2;

/// The whole report.  Costs are 1/2 sum of squares; rms, mean, median and
/// max are of the features' distances.  Units are metres, radians and pixels; `sigma` of a parameter is
/// one standard deviation, null if undetermined.  `covariance` is of all parameters, the lower
/// triangle row by row, zero along the combinations of `undetermined`; `poses` are joint positions.
/// @param files  of the same result: readers refuse a folder in which one is not that of the report
/// Source: schema/report.schema.json beside this header documents every key
[[nodiscard]] std::string json_report(const Findings& findings,
                                      std::span<const OutputFile> files = {});

}  // namespace kinecal
