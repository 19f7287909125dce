// Judging lenses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "kinecal/trust/judge.hpp"

namespace kinecal::detail {

/// A lens that folds over where features are is no result; beyond them it is one for the places where features are.
inline void judge_folds(const Assessment& step, Judgement& judgement) {
  for (const FoldedLens& fold : step.folded) {
    char radii[128];
    (void)std::snprintf(radii, sizeof radii,
                        "%.0f px from the center; its corners are at %.0f px, the farthest "
                        "feature at %.0f px",
                        fold.radius, fold.corner, fold.farthest);
    judgement.add(fold.is_among_features() ? Grade::do_not_use : Grade::use_with_care,
                  "the lens of '" + fold.sensor + "' folds over inside the image, " + radii +
                      (fold.is_among_features()
                           ? "; give it another model ('lens: auto' finds it)"
                           : "; do not use it beyond these, record features up to the corners, or "
                             "hold its last coefficients"),
                  {Remedy::Kind::mend});
  }
}

/// Views that are too few, or too much alike, for intrinsics: only where each sample has a pose of its own, so that
/// nothing else tells of the camera.  Their +- say nothing then: they come from these few.
inline void judge_views(const Assessment& step, const ParameterTable& table, Judgement& judgement) {
  constexpr double kOwn = 5.0;                      // residuals of a sample, of the six of a pose
  constexpr std::int64_t kFewest = 3, kEnough = 8;  // views
  constexpr double kKnown = 0.05;                   // of the focal length
  if (!(step.used > kOwn * static_cast<double>(step.samples))) return;
  for (const int p : step.parameters) {
    const std::string& name = table[p].name;
    if (!name.ends_with("_fx")) continue;
    const std::string camera = name.substr(0, name.size() - 3);
    // Of the length that was found, not of the one that it began with.
    const double deviation = step.deviation(p).value_or(0.0) / std::abs(1.0 + table[p].value);
    if (step.views < kEnough) {
      const std::string different = step.views < step.samples ? " different" : "";
      judgement.add(step.views < kFewest ? Grade::do_not_use : Grade::use_with_care,
                    std::to_string(step.views) + different +
                        (step.views == 1 ? " view is" : " views are") +
                        " too few for the lens of '" + camera +
                        "', and their +- mean little; take 20, tilted by 30 degrees to all sides",
                    {Remedy::Kind::record});
    }
    if (deviation > kKnown) {  // infinite, if not at all
      judgement.add(
          Grade::do_not_use,
          "these views do not tell the focal length of '" + camera + "'" +
              (std::isfinite(deviation) ? " (+- " + reading(1e2 * deviation, "1") + " %)" : "") +
              ": tilt the target by 30 degrees to all sides",
          {Remedy::Kind::record});
    }
  }
}

/// Halves of the samples that put pixels apart, and residuals that depend on the place in the image.  Only if each sample
/// has a pose of its own: else a robot that errs in some poses looks alike, because poses and places go together.
inline void judge_projection(const Assessment& step, Judgement& judgement) {
  if (!(step.used > 0.0)) return;
  constexpr double kChance = 0.01, kPart = 0.35, kSmallChance = 1e-3, kTimes = 2.5, kPixels = 0.1;
  const std::string cause =
      ": its lens has a shape that its model does not have, or the target has one; try another "
      "('lens: auto'), or measure the target";
  for (std::size_t i = 0; i < step.maps.size(); ++i) {
    const ProjectionMap& map = step.maps[i];
    const AlikePixels& alike = step.alike[i];
    if (alike.chance < kChance && alike.alike > std::max(kPixels, kPart * alike.all)) {
      judgement.add(Grade::use_with_care,
                    "residuals of '" + map.sensor + "' depend on the place in its image (" +
                        reading(alike.alike, "px") + " of " + reading(alike.all, "px") +
                        ", most at the " + alike.region + ")" + cause,
                    {Remedy::Kind::mend});
    } else if (map.halves && map.halves->chance < kSmallChance &&
               map.halves->difference > kPixels &&
               map.halves->difference > kTimes * map.halves->allowed) {
      judgement.add(Grade::use_with_care,
                    "two halves of the samples put pixels of '" + map.sensor + "' " +
                        reading(map.halves->difference, "px") + " apart, the +- allow " +
                        reading(map.halves->allowed, "px") + cause,
                    {Remedy::Kind::mend});
    }
  }
}

}  // namespace kinecal::detail
