// Files that do not go with the others.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/trust/assess_shards.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal::detail {

/// RMS of the weighted residuals of each file; infinite if a residual is not defined at these values.
/// @param values  of all parameters of the table
/// @param files   of each sample of the problem: the number of its file, from 0; -1: of none
[[nodiscard]] std::vector<double> misfits_of(const AnyProblem& problem, ParameterValues values,
                                             std::span<const int> files);

/// Judges files whose residuals are much larger than those of most.
/// @param misfits  RMS of the weighted residuals of each
/// @param names    of the files
void judge_misfits(const std::vector<double>& misfits, const std::vector<std::string>& names,
                   Judgement& judgement);

/// Judges what the samples of each file show by themselves.
/// @param names  of the files
void judge_files(const ShardAssessment& found, const std::vector<std::string>& names,
                 Judgement& judgement);

}  // namespace kinecal::detail
