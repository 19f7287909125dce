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

/// Correlation of two explanations from which on they look alike: that of high_correlations().
inline constexpr double kAlike = 0.9;

/// The fewest poses that were found to tell two explanations apart.
struct DecidingPoses {
  std::vector<int> chosen;   ///< without a decision: the best that were found
  bool decide = false;       ///< their correlation is below kAlike
  double correlation = 1.0;  ///< with the poses that exist; 1: not determined
  std::string curve;         ///< a table: correlation by number of poses, selected and random
};

/// @param choice  after choose_between()
/// @param meter   called now and then
[[nodiscard]] DecidingPoses deciding_poses(const StudyInput& input, const PoseChoice& choice,
                                           const ProgressMeter& meter);

}  // namespace kinecal::cli
