// Judging the noise of error blocks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "kinecal/trust/judge.hpp"
#include "kinecal/trust/plausible_change.ipp"

namespace kinecal::detail {

/// A larger sigma was given in the wrong unit, if the noise is far below it.
[[nodiscard]] inline double most_sigma(const std::string& unit) {
  if (unit == "m") return 0.05;
  return unit == "px" ? 30.0 : std::numeric_limits<double>::infinity();
}

inline void judge_noise(const Assessment& step, Judgement& judgement) {
  constexpr Limits kTimes{3.0, 10.0}, kMetres{0.008, 0.02}, kPixels{4.0, 12.0};
  for (const BlockNoise& noise : step.noise) {
    if (noise.features == 0 || noise.freedom <= 0.0) continue;
    // Use both estimates: a few bad captures raise one, a wrong model raises both.
    const double sigma = std::min(noise.sigma, noise.robust);
    const std::string shown = "residuals show " + reading(sigma, noise.unit);
    if (noise.given > 0.0) {
      const double times = sigma / noise.given;
      const bool in_other_unit = times < 0.02 && noise.given > most_sigma(noise.unit);
      if (!kTimes.exceeded(times) && !in_other_unit) continue;
      const std::string unit = noise.unit == "px" ? "pixels" : "metres";
      judgement.add(in_other_unit ? Grade::do_not_use : kTimes.grade(times),
                    "error block '" + noise.block + "': sigma " + reading(noise.given, noise.unit) +
                        " given, " + shown + (in_other_unit ? "; sigma must be in " + unit : ""));
    } else if (noise.unit == "m" || noise.unit == "px") {
      const Limits& limits = noise.unit == "m" ? kMetres : kPixels;
      const double distance = sigma * std::sqrt(noise.components);
      if (!limits.exceeded(distance)) continue;
      judgement.add(limits.grade(distance),
                    "error block '" + noise.block + "': residuals show distances of " +
                        reading(distance, noise.unit) + "; the model does not fit these samples");
    }
  }
}

}  // namespace kinecal::detail
