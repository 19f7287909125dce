// Definitions of likely_causes.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "kinecal/io/assemble.hpp"
#include "kinecal/io/doubts/hypotheses.ipp"
#include "kinecal/io/doubts/likely_causes.hpp"
#include "kinecal/io/doubts/occurrences.hpp"
#include "kinecal/io/doubts/some_samples.ipp"

namespace kinecal {

namespace detail {

/// A calibration solved: its cost and its error blocks.
struct SolvedSamples {
  double cost = 0.0;
  std::vector<BlockStatistics> blocks;
};

/// A mistake explains a bad fit if the cost is this part of it without.
inline constexpr double kExplains = 0.1;

/// Assembles and solves; nullopt if the samples cannot be used so, or if the fit is not finite.
[[nodiscard]] inline std::optional<SolvedSamples> solve_samples(const Config& config,
                                                                const Robot& robot,
                                                                std::span<const Sample> samples,
                                                                const Calibrator& solve) {
  constexpr int kEnough = 100;  // iterations; what fits is found in far fewer
  Diagnostics quiet;
  Calibration calibration = assemble(config, robot, samples, quiet);
  for (CalibrationStep& step : calibration.steps) {
    step.max_num_iterations = std::min(step.max_num_iterations, kEnough);
  }
  if (!quiet.errors.empty() || calibration.steps.empty()) return std::nullopt;
  const CalibrationResult result = solve(calibration);
  if (result.steps.empty() || !std::isfinite(result.steps.back().final_cost)) return std::nullopt;
  return SolvedSamples{result.steps.back().final_cost, result.blocks};
}

/// "the mean residual of 'hand_eye' falls from 93 mm to 0.11 mm", of the block that falls most; of a
/// prior only if no other falls.
[[nodiscard]] inline std::string fall_of(const SolvedSamples& before, const SolvedSamples& after) {
  std::string text = fmt::format("the cost falls from {:.3g} to {:.3g}", before.cost, after.cost);
  double most = 1.0;
  for (const BlockStatistics& block : before.blocks) {
    for (const BlockStatistics& same : after.blocks) {
      const double ratio = block.after.mean / std::max(same.after.mean, 1e-300);
      if (same.name != block.name || block.unit == "1" || !(ratio > most)) continue;
      most = ratio;
      text = fmt::format("the mean residual of '{}' falls from {} to {}", block.name,
                         residual_text(block.after.mean, block.unit),
                         residual_text(same.after.mean, same.unit));
    }
  }
  return text;
}

/// A mistake that explains the residuals.
struct Cause {
  double cost = 0.0;  ///< without it
  std::string sentence;
};

/// The factor of a model's points with which the samples fit best: a board whose squares are larger than
/// was said.  Parabolas through three costs, over the logarithm of the factor.
[[nodiscard]] inline std::optional<Cause> scale_cause(const Config& config, const Robot& robot,
                                                      const std::vector<Sample>& samples,
                                                      const std::string& model,
                                                      const SolvedSamples& now,
                                                      const Calibrator& solve) {
  const auto fit = [&](double x) {
    std::vector<Sample> scaled = samples;
    for (Sample& sample : scaled) {
      for (Observation& seen : sample.observations) {
        if (seen.sensor != model) continue;
        for (Feature& feature : seen.features) feature.point *= std::exp(x);
      }
    }
    return solve_samples(config, robot, scaled, solve);
  };
  constexpr double kFirst = 0.1, kFurthest = 1.1, kEnough = 1e-3;
  constexpr int kSteps = 8;
  double best = 0.0, step = kFirst;
  SolvedSamples at_best = now;
  for (int i = 0; i < kSteps && step > kEnough; ++i) {
    const auto below = fit(best - step), above = fit(best + step);
    if (!below || !above) return std::nullopt;
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
    step = std::min(step, std::max(0.1 * step, std::abs(move)));
  }
  if (at_best.cost * std::max(1.0, std::exp(-2.0 * best)) >= kExplains * now.cost) {
    return std::nullopt;
  }
  return Cause{at_best.cost, fmt::format("with the points of '{}' multiplied by {:.4g}, {}", model,
                                         std::exp(best), fall_of(now, at_best))};
}

/// The sentences, the lowest costs first; alike costs in the order of the hypotheses.  What only
/// explains a part beside a better one is left out, and so is what does the same to the samples.
[[nodiscard]] inline std::vector<std::string> sentences(std::vector<Cause> found) {
  constexpr double kAlike = 1.5, kPartly = 100.0;
  double best = HUGE_VAL;
  for (const Cause& cause : found) best = std::min(best, cause.cost);
  std::erase_if(found, [&](const Cause& cause) { return cause.cost > kPartly * best; });
  std::set<double> costs;
  std::erase_if(found, [&](const Cause& cause) { return !costs.insert(cause.cost).second; });
  for (Cause& cause : found) cause.cost = std::max(cause.cost, kAlike * best);
  std::stable_sort(found.begin(), found.end(),
                   [](const Cause& a, const Cause& b) { return a.cost < b.cost; });
  std::vector<std::string> all;
  for (Cause& cause : found) all.push_back(std::move(cause.sentence));
  return all;
}

}  // namespace detail

KINECAL_INLINE std::vector<std::string> likely_causes(const Config& config, const Robot& robot,
                                                      std::span<const Sample> samples,
                                                      const Calibrator& solve) {
  const Calibrator solver =
      solve ? solve : [](const Calibration& calibration) { return calibrate(calibration); };
  const std::vector<Sample> some = detail::some_of(samples);
  const auto now = detail::solve_samples(config, robot, some, solver);
  std::vector<detail::Cause> found;
  for (const auto& hypothesis :
       detail::hypotheses(config, detail::used_joints(config, robot, some))) {
    std::vector<Sample> changed = some;
    Config changed_config = config;
    if (hypothesis.correct) std::for_each(changed.begin(), changed.end(), hypothesis.correct);
    if (hypothesis.correct_config) hypothesis.correct_config(changed_config);
    const auto then = detail::solve_samples(changed_config, robot, changed, solver);
    if (!then) continue;
    const double cost = then->cost / (hypothesis.shrinks * hypothesis.shrinks);
    if (now && cost >= detail::kExplains * now->cost) continue;
    found.push_back({cost, hypothesis.undone + ", " +
                               (now ? detail::fall_of(*now, *then) : "the samples can be solved")});
  }
  const std::set<std::string> pixels = detail::pixel_models(config);
  for (const ModelConfig& model : detail::models_of(config)) {
    if (!now || pixels.contains(model.name)) continue;
    auto scaled = detail::scale_cause(config, robot, some, model.name, *now, solver);
    if (scaled) found.push_back(*std::move(scaled));
  }
  return detail::sentences(std::move(found));
}

}  // namespace kinecal
