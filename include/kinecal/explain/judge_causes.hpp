// What explains a bad result, as reasons of its verdict.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/config/doubts/find_doubts.hpp"
#include "kinecal/explain/suspect.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"

namespace kinecal {

/// Adds cameras and joint offsets that cannot be, and mistakes that explain a bad fit: with them a result is
/// not to be used.
/// @param input   the calibration of the result, with the samples that were used
/// @param all     those and the samples that were left out because they do not fit, as they were recorded
/// @param judged  its result
/// @param own     suspects of the program, beside suspects_of()
void judge_causes(const CalibrationInput& input, std::span<const Sample> all, JudgedResult& judged,
                  std::span<const Suspect> own = {});

/// Adds to a good fit that another scale of a target explains lengths better.
void judge_scales(const CalibrationInput& input, JudgedResult& judged);

}  // namespace kinecal
