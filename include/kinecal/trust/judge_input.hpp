// What a calibration does not use of its samples, and samples that occur twice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal {

/// The end of a sentence about copies.
inline constexpr std::string_view kCopiesCountTwice =
    "copies count twice and say nothing new; remove them";

/// Judges what the steps of a calibration do not use of their samples: observations under names that no sensor has,
/// features that are not numbers, samples that no error block compares; and samples that are copies of others.
/// One of fifty copies, a tenth of the samples under a misspelt name, and a quarter left out as not a number are
/// reasons to use the result with care; copies of one sample alone, not to use it.
/// @param doubts  about the input, which may name copies already
/// @returns       all of it as sentences, reasons of the verdict or not
[[nodiscard]] std::vector<std::string> judge_input(const Calibration& calibration,
                                                   const std::vector<std::string>& doubts,
                                                   Judgement& judgement);

}  // namespace kinecal
