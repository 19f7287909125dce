// What explains a bad result, as reasons of its verdict.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/config/doubts/find_doubts.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"

namespace kinecal {

/// Adds cameras and joint offsets that cannot be, and mistakes that explain a bad fit: with them a result is
/// not to be used.  To a good fit it adds lengths that another scale of a target explains better, and a
/// frame that is held and explains residuals.
/// @param input   the calibration of the result, with the samples that were used
/// @param judged  its result
void judge_causes(const CalibrationInput& input, JudgedResult& judged);

}  // namespace kinecal
