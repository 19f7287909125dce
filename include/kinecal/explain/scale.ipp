// The scale of points with which samples fit best: a board with larger squares than configured.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/explain/refit.ipp"

namespace kinecal::detail {

/// A fit at another scale of points.
struct ScaledFit {
  double factor = 1.0;
  Refit after;
};

/// The fitted samples at another scale.
[[nodiscard]] inline std::vector<Sample> with_scaled(const Refits& refits, const Suspect& suspect,
                                                     double factor) {
  std::vector<Sample> samples = refits.some();
  for (Sample& sample : samples) suspect.scale(sample, factor);
  return samples;
}

/// The fit at the best scale, by parabolas through three costs over the logarithm of the scale; nullopt if it leaves
/// more than a part of the cost, in units that do not shrink.
[[nodiscard]] inline std::optional<ScaledFit> scaled_fit(const Refits& refits,
                                                         const Suspect& suspect, const Refit& now,
                                                         double part) {
  const auto fit = [&](double x) { return refits.with(with_scaled(refits, suspect, std::exp(x))); };
  constexpr double kFirst = 0.1, kFurthest = 1.1, kEnough = 1e-3, kNothing = 1e-6;
  constexpr int kSteps = 8;
  double best = 0.0, step = kFirst;
  Refit at_best = now;
  for (int i = 0; i < kSteps && step > kEnough; ++i) {
    const auto above = fit(best + step);
    if (!above) return std::nullopt;
    if (i == 0 && std::abs(above->cost - now.cost) < kNothing * now.cost) {
      return std::nullopt;  // no sample knows it, as where cameras alone see a board
    }
    const auto below = fit(best - step);
    if (!below) return std::nullopt;
    const double curvature = below->cost - 2.0 * at_best.cost + above->cost;
    const double slope = 0.5 * (above->cost - below->cost);
    const double most = 4.0 * step;
    const double move = curvature > 0.0 ? std::clamp(-slope / curvature * step, -most, most)
                                        : (slope > 0.0 ? -most : most);
    const auto next = fit(best + move);
    if (!next || std::abs(best + move) > kFurthest) return std::nullopt;
    if (next->cost < at_best.cost) {
      best += move;
      at_best = *next;
    }
    if (i == 0 && std::abs(move) < most && at_best.cost > 2.0 * part * now.cost) {
      return std::nullopt;  // the parabola shows well enough that nothing can be gained
    }
    step = std::min(step, std::max(0.1 * step, std::abs(move)));
  }
  if (at_best.cost * std::max(1.0, std::exp(-2.0 * best)) >= part * now.cost) return std::nullopt;
  return ScaledFit{std::exp(best), std::move(at_best)};
}

/// Scales of points at which the noise is half as large, as sentences.
/// @param scales  suspects that are scales
[[nodiscard]] inline std::vector<std::string> scale_sentences(const Refits& refits,
                                                              const Refit& now,
                                                              const std::vector<Suspect>& scales) {
  constexpr double kHalfNoise = 0.25;
  std::vector<std::string> found;
  for (const Suspect& suspect : scales) {
    const auto scaled = scaled_fit(refits, suspect, now, kHalfNoise);
    if (!scaled) continue;
    found.push_back(fmt::format("{}multiplied by {:.4g}, {}", suspect.undone, scaled->factor,
                                fall_of(now, scaled->after)));
  }
  return found;
}

}  // namespace kinecal::detail
