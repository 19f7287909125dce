// Definitions of judge_noise.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/judge_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kinecal::detail {

double most_sigma(const std::string& unit) {
  if (unit == "m") return 0.05;
  return unit == "px" ? 30.0 : std::numeric_limits<double>::infinity();
}

Limits distance_limits(const std::string& unit, double size) {
  constexpr double kMetre = 1.0;
  if (unit == "px") return {4.0, 12.0};
  const double part = size > 0.0 ? std::min(1.0, size / kMetre) : 1.0;
  return {0.008 * part, 0.02 * part};
}

void judge_poses(const BlockNoise& noise, double size, Judgement& judgement) {
  const Limits distances = distance_limits("m", size);
  const Grade grade = std::max(distances.judged(noise.distance), kPoseAngles.judged(noise.angle));
  if (grade == Grade::good) return;
  judgement.add(grade, "error block '" + noise.block + "': poses differ by " +
                           reading(noise.distance, "m") + " and " + reading(noise.angle, "rad") +
                           "; the model does not fit these samples");
}

Grade grade_of_sigma(double times, double distance, const Limits& distances) {
  constexpr double kRefuse = 10.0, kGoodEnough = 0.25;
  return times < kRefuse || distance < kGoodEnough * distances.care ? Grade::use_with_care
                                                                    : Grade::do_not_use;
}

void judge_directions(const Assessment& step, Judgement& judgement) {
  constexpr double kTimes = 5.0;
  for (const BlockNoise& noise : step.noise) {
    if (!(noise.across > 0.0) || !(noise.along > kTimes * noise.across)) continue;
    judgement.add(Grade::use_with_care,
                  "error block '" + noise.block + "': residuals scatter by " +
                      reading(noise.along, noise.unit) + " in one direction and by " +
                      reading(noise.across, noise.unit) + " across it; is an axis of a sensor bad?",
                  {Remedy::Kind::mend});
  }
}

void judge_noise(const Assessment& step, Judgement& judgement) {
  constexpr double kTimes = 3.0;
  for (const BlockNoise& noise : step.noise) {
    if (noise.features == 0 || noise.freedom <= 0.0) continue;
    // Use both estimates: a few bad captures raise one, a wrong model raises both.
    const double sigma = std::min(noise.sigma, noise.robust);
    const double distance = sigma * std::sqrt(noise.components);
    const Limits limits = distance_limits(noise.unit, step.size);
    const std::string shown = "residuals show " + reading(sigma, noise.unit);
    if (noise.given > 0.0) {
      const double times = sigma / noise.given;
      const bool in_other_unit = times < 0.02 && noise.given > most_sigma(noise.unit);
      if (!(times > kTimes) && !in_other_unit) continue;
      const std::string unit = noise.unit == "px" ? "pixels" : "metres";
      const Grade grade = grade_of_sigma(times, distance, limits);
      judgement.add(
          in_other_unit ? Grade::do_not_use : grade,
          "error block '" + noise.block + "': sigma " + reading(noise.given, noise.unit) +
              " given, " + shown +
              (in_other_unit ? "; sigma must be in " + unit
               : grade == Grade::use_with_care
                   ? "; sigma is that of a residual, errors of the robot included"
                   : "; the model does not fit these samples"),
          in_other_unit || grade == Grade::use_with_care
              ? Remedy{Remedy::Kind::mend,
                       "give the sigma of '" + noise.block + "'" +
                           (in_other_unit ? " in " + unit : " as " + reading(sigma, noise.unit))}
              : Remedy{});
    } else if (noise.unit == "m" || noise.unit == "px") {
      if (!limits.exceeded(distance)) continue;
      judgement.add(limits.grade(distance),
                    "error block '" + noise.block + "': residuals show distances of " +
                        reading(distance, noise.unit) + "; the model does not fit these samples");
    } else {
      judge_poses(noise, step.size, judgement);
    }
  }
}

bool fits_to_noise(const Assessment& step) {
  constexpr double kOfLimit = 0.25;
  bool some = false;
  for (const BlockNoise& noise : step.noise) {
    const bool is_distance = noise.unit == "m" || noise.unit == "px";
    if (noise.features == 0 || noise.freedom <= 0.0 || !is_distance) continue;
    const double distance = std::min(noise.sigma, noise.robust) * std::sqrt(noise.components);
    if (distance > kOfLimit * distance_limits(noise.unit, step.size).care) return false;
    some = true;
  }
  Judgement of_noise;
  judge_noise(step, of_noise);
  return some && of_noise.verdict == Grade::good;
}

}  // namespace kinecal::detail
