// Judging the values of parameters: changes that are not plausible, bounds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/trust/judge.hpp"
#include "kinecal/trust/plausible_change.hpp"

namespace kinecal::detail {

/// The change of a parameter; relative for a ratio: 1 + v, or v itself if its bounds are above zero, as of the scales of a
/// base, which begin at 1.
[[nodiscard]] double change_of(const Parameter& p);

/// Of a zero that is about a quarter or half turn off: how a servo was screwed on.
[[nodiscard]] std::string turned_text(const Parameter& p);

/// A turn by more than half a turn, or a shift by more than the robot is large: no mistake has this effect, but the valley
/// of a problem that the samples leave open.
[[nodiscard]] bool ran_off(const Parameter& p, double by, double size);

/// Changes that are not plausible: the worst, by its limits, and how many more.
/// @param size  of the robot, metres
void judge_changes(const CalibrationStep& step, const CalibrationResult& result, double size,
                   Judgement& judgement);

/// Frames that are not in the URDF, and ended far from where the configuration says they are.  Nobody misjudges by so
/// much where a part is: something else is wrong and looks like that, or the initial value is.
/// @param size  of the robot, metres
void judge_given_places(const AnyProblem& problem, const ParameterTable& table, double size,
                        Judgement& judgement);

/// Sag and play that are surely negative: no joint yields against its load.
void judge_signs(const CalibrationStep& step, const CalibrationResult& result,
                 const Assessment& assessment, Judgement& judgement);

void judge_values(const CalibrationStep& step, const CalibrationResult& result,
                  const Assessment& assessment, Judgement& judgement);

}  // namespace kinecal::detail
