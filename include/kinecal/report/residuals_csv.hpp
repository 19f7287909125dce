// Exports the residuals of a result as a table.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/report/findings.hpp"

namespace kinecal {

/// A row for each feature of the last step: error block, sample, its source location, feature,
/// unit, distance, and the residual's components residual_1, residual_2, ..., as many as the
/// largest block has; rows of smaller blocks end in empty cells.  The feature is its number, from
/// 1, in the list of the block's first sensor; a column `id` follows if any feature has one.
/// @param calibration  the one that was solved, with its samples
[[nodiscard]] std::string residuals_csv(const Calibration& calibration, const Findings& findings);

}  // namespace kinecal
