// Judging a change during the recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

inline void judge_change(const Assessment& step, const AnyProblem& problem, Judgement& judgement) {
  if (!step.change) return;
  constexpr double kThird = 1.0 / 3.0;
  const RecordingChange& change = *step.change;
  const std::string noise = reading(1e2 * change.noise_left, "1") + " %";
  const std::string size = size_of(change);
  std::string text;
  if (change.drifts) {
    text = "'" + change.owner + "' drifts" + (size.empty() ? "" : " by " + size) +
           " from the first sample to the last: with an even drift, the noise falls to " + noise +
           "; temperature, or something that comes loose; record again, faster";
  } else {
    text = "'" + change.owner + "' seems to have changed" + (size.empty() ? "" : " by " + size) +
           " during the recording, before " + problem.source(change.sample) +
           ": with one value before and another after, the noise falls to " + noise +
           "; calibrate with the samples of one part";
  }
  judgement.add(change.noise_left < kThird ? Grade::do_not_use : Grade::use_with_care, text);
}

}  // namespace kinecal::detail
