// Judging what residuals depend on: a change during the recording, a joint.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <numbers>
#include <string>

#include "kinecal/trust/judge.hpp"
#include "kinecal/trust/plausible_change.ipp"

namespace kinecal::detail {

/// "10.2 mm and 0.57 deg"; without what is only rounding.
[[nodiscard]] inline std::string size_of(const RecordingChange& change) {
  constexpr double kRounding = 1e-7;  // metres or radians
  std::string text;
  if (change.metres > kRounding) text = reading(1e3 * change.metres, "1") + " mm";
  if (change.radians > kRounding) {
    text += (text.empty() ? "" : " and ") +
            reading(change.radians * 180.0 / std::numbers::pi, "1") + " deg";
  }
  return text;
}

/// "with a backlash of 'elbow' of 1 deg"
[[nodiscard]] inline std::string error_of(const ResidualPattern& pattern) {
  const std::string size = pattern.turns
                               ? reading(pattern.size * 180.0 / std::numbers::pi, "1") + " deg"
                               : reading(1e3 * pattern.size, "1") + " mm";
  const std::string owner = "'" + pattern.owner + "'";
  char factor[32];
  (void)std::snprintf(factor, sizeof factor, "%.5g", pattern.factor);  // gears are near one
  switch (pattern.course) {
    case ErrorCourse::zero:
      return "with a zero of " + owner + " that is " + size + " off (it is held)";
    case ErrorCourse::gear:
      return "with a gear of " + owner + " of " + factor + ", an error of up to " + size;
    case ErrorCourse::turn:
      return "with an error of " + owner + " of " + size +
             " that returns once a turn (an eccentric encoder, or a link beside it that is held)";
    case ErrorCourse::backlash:
      return "with a backlash of " + owner + " of " + size;
    case ErrorCourse::sag:
      return "if " + owner + " sags by up to " + size + " under the weight of the arm";
    case ErrorCourse::lag:
      return "if the joints " +
             std::string(pattern.size > 0.0 ? "had still to go " : "had already gone on by ") +
             reading(1e2 * std::abs(pattern.size), "1") +
             " % of the way from the sample before (stamps differ, or samples were taken before "
             "the robot stood)";
    case ErrorCourse::rounding:
      return "positions of " + owner + " are rounded to multiples of " + size +
             "; without rounding";
    case ErrorCourse::scale:
      return "with the points of " + owner + " multiplied by " + factor;
    case ErrorCourse::axis:
      break;
  }
  return "with the " + std::string(1, "xyz"[pattern.axis]) + " of sensor " + owner +
         " multiplied by " + factor;
}

/// A pattern that explains more than a change during the recording.
[[nodiscard]] inline bool judge_pattern(const Assessment& step, Judgement& judgement) {
  if (!step.pattern) return false;
  constexpr double kSimpler =
      0.1;  // backlash splits samples in two as well, by where they came from
  const bool is_split = step.change && !step.change->here_and_there.empty();
  const double to_beat = step.change ? step.change->noise_left + (is_split ? kSimpler : 0.0) : 1.0;
  if (step.change && to_beat <= step.pattern->noise_left) return false;
  judgement.add_causes(Grade::use_with_care, {error_of(*step.pattern) + ", the noise falls to " +
                                              reading(1e2 * step.pattern->noise_left, "1") +
                                              " %; the model does not contain that"});
  return true;
}

inline void judge_change(const Assessment& step, const AnyProblem& problem, Judgement& judgement) {
  if (judge_pattern(step, judgement) || !step.change) return;
  constexpr double kThird = 1.0 / 3.0;
  const RecordingChange& change = *step.change;
  const std::string noise = reading(1e2 * change.noise_left, "1") + " %";
  const std::string size = size_of(change);
  const std::string owner =
      change.owner.empty() ? "the zeros of all joints" : "'" + change.owner + "'";
  const std::string by = size.empty() ? "" : " by " + size;
  std::string text;
  if (change.drifts) {
    text = owner + " drifts" + by + " from the first sample to the last: with an even drift, the " +
           "noise falls to " + noise +
           "; temperature, or something that comes loose; record again, faster";
  } else if (!change.here_and_there.empty()) {
    text = owner + (change.owner.empty() ? " are" : " is") + " elsewhere" + by + " in " +
           std::to_string(change.here_and_there.size()) + " of " +
           std::to_string(problem.num_samples()) + " samples, of which the first is " +
           problem.source(change.here_and_there.front()) +
           ": with another value in these, the noise falls to " + noise +
           "; are they of another robot, or of another recording? calibrate them apart";
  } else if (change.end > 0) {
    text = owner + " seems to have changed" + by + " from " + problem.source(change.sample) +
           " until " + problem.source(change.end) +
           ": with another value in these samples, the noise falls to " + noise +
           "; calibrate without them";
  } else {
    text = owner + " seems to have changed" + by + " during the recording, before " +
           problem.source(change.sample) +
           ": with one value before and another after, the noise falls to " + noise +
           "; calibrate with the samples of one part";
  }
  if (change.by_pose) {
    text +=
        "; or an error that depends on the pose does, as the order of the samples is that of their "
        "poses: record in a random order";
  }
  const bool refuse = change.noise_left < kThird && !change.by_pose;
  judgement.add_causes(refuse ? Grade::do_not_use : Grade::use_with_care, {text});
}

}  // namespace kinecal::detail
