// Poses that tell two explanations apart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "pose_choice.hpp"
#include "study_input.hpp"

namespace kinecal::cli {

/// Makes the choice one of poses that tell the two explanations of a study apart.
/// @throws InputError  if no pose does
void choose_between(const StudyInput& input, PoseChoice& choice);

/// What some poses say of both explanations, beside as many random ones: standard deviations, correlation.
[[nodiscard]] std::string explanations_text(const StudyInput& input, const PoseChoice& choice,
                                            const std::vector<int>& chosen);

}  // namespace kinecal::cli
