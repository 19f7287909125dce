// Definitions of likely_causes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/likely_causes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "kinecal/config/doubts/absorbed_scale.ipp"
#include "kinecal/config/doubts/cause_solver.ipp"
#include "kinecal/config/doubts/pose_hypotheses.ipp"
#include "kinecal/config/doubts/some_samples.ipp"
#include "kinecal/text/first_names.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A mistake explains a bad fit if undoing it leaves this fraction of the cost.
constexpr double kExplains = 0.1;
/// A scale of points is wrong if correcting it halves the noise: it is one number of a continuum, and noise that
/// stays is no argument against it.
constexpr double kExplainsScale = 0.25;
/// Costs that are alike, and the cost of a cause that explains only a part, in lowest costs.
constexpr double kAlike = 1.5, kPartly = 100.0;

/// The scale of a model's points that fits best: a board with larger squares than configured.  Fits
/// parabolas through three costs, over the logarithm of the scale.
[[nodiscard]] std::optional<Cause> scale_cause(const CauseSolver& solver,
                                               const Calibration& calibration,
                                               const std::vector<Sample>& samples,
                                               const std::string& model, const SolvedSamples& now,
                                               double explains) {
  const auto fit = [&](double x) {
    return solved_with(solver, calibration, with_scaled(samples, model, std::exp(x)));
  };
  constexpr double kFirst = 0.1, kFurthest = 1.1, kEnough = 1e-3, kNothing = 1e-6;
  constexpr int kSteps = 8;
  double best = 0.0, step = kFirst;
  SolvedSamples at_best = now;
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
    if (i == 0 && std::abs(move) < most &&
        at_best.cost > 2.0 * std::max(explains, kExplains) * now.cost) {
      return std::nullopt;  // the parabola shows well enough that nothing can be gained
    }
    step = std::min(step, std::max(0.1 * step, std::abs(move)));
  }
  if (at_best.cost * std::max(1.0, std::exp(-2.0 * best)) >= explains * now.cost) {
    return std::nullopt;
  }
  return Cause{at_best.cost, fmt::format("with the points of '{}' multiplied by {:.4g}, {}", model,
                                         std::exp(best), fall_of(now, at_best))};
}

/// The models whose points fit better at another scale.
[[nodiscard]] std::vector<Cause> scale_causes(const CauseSolver& solver,
                                              const Calibration& calibration,
                                              const std::vector<Sample>& samples,
                                              const SolvedSamples& now, double explains) {
  std::vector<Cause> found;
  const std::set<std::string> pixels = pixel_models(solver.config);
  for (const ModelConfig& model : models_of(solver.config)) {
    if (pixels.contains(model.name)) continue;
    auto scaled = scale_cause(solver, calibration, samples, model.name, now, explains);
    if (scaled) found.push_back(*std::move(scaled));
  }
  return found;
}

/// The models whose points fit better at another scale, if zeros are free in place of lengths.
[[nodiscard]] std::vector<Cause> scales_with_zeros(const Config& config, const Robot& robot,
                                                   const std::vector<Sample>& samples,
                                                   const std::vector<FreeLength>& lengths) {
  const Config zeros = with_zeros_for_lengths(config, robot);
  const CauseSolver solver{zeros, robot, plain_calibrator()};
  const std::optional<Calibration> calibration = assembled(solver, zeros, samples);
  const auto now = calibration ? solved(solver, *calibration) : std::nullopt;
  if (!now) return {};
  std::vector<std::string> names;
  for (const FreeLength& length : lengths) names.push_back(length.name);
  std::vector<Cause> found = scale_causes(solver, *calibration, samples, *now, kExplainsScale);
  for (Cause& cause : found) {
    cause.sentence +=
        " with zeros in place of " + first_names(names) + ", which may have absorbed it";
  }
  return found;
}

/// Solves with a mistake undone.  Only what changes the configuration, or the number of samples, is assembled anew.
/// @param calibration  of `some` of the samples; nullopt if it cannot be assembled
[[nodiscard]] std::optional<SolvedSamples> solved_without(
    const Hypothesis& hypothesis, const CauseSolver& solver,
    const std::optional<Calibration>& calibration, std::span<const Sample> samples,
    const std::vector<Sample>& some) {
  std::vector<Sample> changed = some;
  if (hypothesis.correct_all) {
    changed.assign(samples.begin(), samples.end());
    hypothesis.correct_all(changed);
    changed = some_of(changed);
  }
  if (hypothesis.correct) std::for_each(changed.begin(), changed.end(), hypothesis.correct);
  if (!hypothesis.correct_config && calibration && changed.size() == some.size()) {
    return solved_with(solver, *calibration, changed);
  }
  Config config = solver.config;
  if (hypothesis.correct_config) hypothesis.correct_config(config);
  const auto other = assembled(solver, config, changed);
  return other ? solved(solver, *other) : std::nullopt;
}

/// The sentences, lowest cost first; equal costs in the order of the hypotheses.  Drops causes that
/// only explain a part of a better one, or that change the samples in the same way.
/// @param partly  times the lowest cost: what explains only a part
[[nodiscard]] std::vector<std::string> sentences(std::vector<Cause> found,
                                                 double partly = kPartly) {
  double best = HUGE_VAL;
  for (const Cause& cause : found) best = std::min(best, cause.cost);
  std::erase_if(found, [&](const Cause& cause) { return cause.cost > partly * best; });
  std::set<double> costs;
  std::erase_if(found, [&](const Cause& cause) { return !costs.insert(cause.cost).second; });
  for (Cause& cause : found) cause.cost = std::max(cause.cost, kAlike * best);
  std::stable_sort(found.begin(), found.end(),
                   [](const Cause& a, const Cause& b) { return a.cost < b.cost; });
  std::vector<std::string> all;
  for (Cause& cause : found) all.push_back(std::move(cause.sentence));
  return all;
}

}  // namespace
}  // namespace detail

std::vector<std::string> likely_causes(const Config& config, const Robot& robot,
                                       std::span<const Sample> samples, const Calibrator& solve) {
  const detail::CauseSolver solver{config, robot, solve ? solve : detail::plain_calibrator()};
  const std::vector<Sample> some = detail::some_of(samples);
  const std::optional<Calibration> calibration = detail::assembled(solver, config, some);
  const auto now = calibration ? detail::solved(solver, *calibration) : std::nullopt;
  std::vector<detail::Cause> found;
  std::vector<detail::Hypothesis> all =
      detail::hypotheses(config, detail::used_joints(config, robot, some));
  detail::add_pose_hypotheses(config, some, all);
  for (const detail::Hypothesis& hypothesis : all) {
    const auto then = detail::solved_without(hypothesis, solver, calibration, samples, some);
    if (!then) continue;
    if (!now) {
      if (!detail::fits(*then)) continue;  // it can be solved, but is wrong, too
      found.push_back({then->cost, hypothesis.undone + ", " + detail::solved_text(*then)});
      continue;
    }
    const double cost = then->cost / (hypothesis.shrinks * hypothesis.shrinks);
    if (cost >= detail::kExplains * now->cost) continue;
    found.push_back({cost, hypothesis.undone + ", " + detail::fall_of(*now, *then)});
  }
  if (now) {
    for (detail::Cause& cause :
         detail::scale_causes(solver, *calibration, some, *now, detail::kExplainsScale)) {
      found.push_back(std::move(cause));
    }
  }
  return detail::sentences(std::move(found), now ? detail::kPartly : detail::kAlike);
}

std::vector<std::string> wrong_scales(const Config& config, const Robot& robot,
                                      std::span<const Sample> samples,
                                      const ParameterTable& solution, const Assessment& last) {
  const detail::CauseSolver solver{config, robot, detail::plain_calibrator(), &solution};
  const std::vector<Sample> some = detail::some_of(samples);
  const std::optional<Calibration> calibration = detail::assembled(solver, config, some);
  const auto now = calibration ? detail::solved(solver, *calibration) : std::nullopt;
  const auto is_exact = [](const BlockStatistics& block) {
    return block.after.mean < 1e-6;  // metres or pixels: simulated without noise
  };
  if (!now || std::all_of(now->blocks.begin(), now->blocks.end(), is_exact)) return {};
  std::vector<detail::Cause> found =
      detail::scale_causes(solver, *calibration, some, *now, detail::kExplainsScale);
  if (!found.empty()) return detail::sentences(std::move(found));
  const std::vector<detail::FreeLength> lengths = detail::free_lengths(robot, solution, last);
  if (lengths.size() < 2) return {};
  const std::set<std::string> pixels = detail::pixel_models(config);
  for (const ModelConfig& model : detail::models_of(config)) {
    if (pixels.contains(model.name)) continue;
    auto scaled = detail::absorbed_scale(solver, *calibration, some, model.name, *now, lengths);
    if (scaled) found.push_back(*std::move(scaled));
  }
  if (found.empty()) found = detail::scales_with_zeros(config, robot, some, lengths);
  return detail::sentences(std::move(found));
}

}  // namespace kinecal
