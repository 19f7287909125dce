// Fits samples with suspects undone, and describes the change.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/errors/pose_to_pose.hpp"
#include "kinecal/explain/explain_fit.hpp"
#include "kinecal/explain/suspect.hpp"
#include "kinecal/solve/fit_frames.hpp"
#include "kinecal/trust/judge_noise.hpp"
#include "kinecal/trust/judge_values.hpp"

namespace kinecal::detail {

/// A fit: its cost, its error blocks and all parameters.
struct Refit {
  double cost = 0.0;
  std::vector<BlockStatistics> blocks;
  ParameterTable table;
  double size = 0.0;    ///< of the robot, metres
  int implausible = 0;  ///< parameters that moved farther than robots are wrong
  double strain = 0.0;  ///< sum of squared moves of parameters, each over its largest plausible one
};

/// True if an error block's residuals are distances.
[[nodiscard]] inline bool is_distance(const BlockStatistics& block) {
  return block.unit == "m" || block.unit == "px";
}

/// True if the typical distances of all error blocks are below those of a good result; residuals of other units, such as
/// those of poses, have no such limit.
[[nodiscard]] inline bool fits(const Refit& fit) {
  return std::all_of(fit.blocks.begin(), fit.blocks.end(), [&](const BlockStatistics& block) {
    return block.count == 0 || !is_distance(block) ||
           block.after.median < distance_limits(block.unit, fit.size).care;
  });
}

/// Which samples are fitted: every n-th, but for the first and the last one, which have no neighbour.
[[nodiscard]] inline std::vector<std::size_t> drawn(std::size_t count, std::size_t most) {
  constexpr std::size_t kFew = 6;
  const std::size_t first = count > kFew ? 1 : 0, last = count - first;
  const std::size_t step = std::max<std::size_t>(1, (last - first + most - 1) / most);
  std::vector<std::size_t> all;
  for (std::size_t i = first; i < last; i += step) all.push_back(i);
  return all;
}

/// Fits some of the samples with suspects undone.  Only what changes the configuration is assembled anew.
class Refits {
 public:
  /// @param from  where fits begin, instead of the initial values; nullptr: there
  Refits(const Config& config, const Robot& robot, std::span<const Sample> samples,
         const Calibrator& solve, const ParameterTable* from = nullptr, std::size_t most = 100)
      : config_(config),
        robot_(robot),
        samples_(samples),
        solve_(solve),
        from_(from),
        draw_(drawn(samples.size(), most)),
        some_(taken(samples)),
        calibration_(assembled(config, some_)) {}

  /// The same of fewer samples.
  [[nodiscard]] Refits with_at_most(std::size_t most) const {
    return {config_, robot_, samples_, solve_, from_, most};
  }

  [[nodiscard]] const std::vector<Sample>& some() const { return some_; }  ///< that are fitted
  /// Numbers of them among all.
  [[nodiscard]] const std::vector<std::size_t>& draw() const { return draw_; }
  /// The cost with suspects undone, if only unknown poses move from an earlier fit; nullopt if that cannot be fitted.
  [[nodiscard]] std::optional<double> cost_of_poses(const std::vector<const Suspect*>& suspects,
                                                    const Refit& at) const {
    if (!calibration_ || calibration_->steps.size() != 1) return std::nullopt;
    try {
      Calibration calibration = with_samples(*calibration_, corrected(suspects));
      calibration.steps.back().free = unknown();
      calibration.steps.back().assignments.clear();
      const Eigen::VectorXd values = at.table.values();
      calibration.begin.assign(values.begin(), values.end());
      const auto fit = solved(calibration);
      return fit ? std::optional(fit->cost) : std::nullopt;
    } catch (const SampleError&) {
      return std::nullopt;
    }
  }
  /// Number of samples that determine parameters of the last step.
  [[nodiscard]] std::size_t fewest(const FreeSet& free) const {
    const CalibrationStep& last = calibration_->steps.back();
    const double rows = static_cast<double>(last.problem->num_residuals());
    const double each = std::max(1.0, rows / static_cast<double>(some_.size()));
    return 2 + static_cast<std::size_t>(static_cast<double>(free.size()) / each);
  }
  /// False if these samples cannot be fitted: then there is no problem.
  [[nodiscard]] bool is_assembled() const { return calibration_.has_value(); }
  /// True if rough_cost() is known.
  [[nodiscard]] bool is_in_one_step() const {
    return !calibration_ || calibration_->steps.size() == 1;
  }
  /// True if all residuals are pixels, which do not shrink with the points.
  [[nodiscard]] bool are_of_pixels() const {
    if (!calibration_) return false;
    for (int t = 0; t < problem().num_terms(); ++t) {
      if (problem().term(t).options.unit != "px") return false;
    }
    return true;
  }
  /// The free parameters of the last step.
  [[nodiscard]] const FreeSet& free() const { return calibration_->steps.back().free; }
  /// The problem of the last step.
  [[nodiscard]] const AnyProblem& problem() const { return *calibration_->steps.back().problem; }
  /// Of the samples as they are; nullopt: they cannot be fitted.
  [[nodiscard]] std::optional<Refit> as_given() const {
    return calibration_ ? solved(*calibration_) : std::nullopt;
  }
  /// With other numbers in the fitted samples; nullopt if they cannot be fitted.
  [[nodiscard]] std::optional<Refit> with(std::span<const Sample> some) const {
    const auto other = replaced(some);
    return other ? solved(*other) : std::nullopt;
  }
  /// The free parameters of the last step that may end anywhere: poses that nobody knows.  All, if no pose is unknown.
  [[nodiscard]] FreeSet unknown() const {
    constexpr double kAnywhere = 1e9;
    const CalibrationStep& last = calibration_->steps.back();
    std::vector<int> unknown;
    for (const int p : last.free.parameters()) {
      if (plausible_change(last, p).care > kAnywhere) unknown.push_back(p);
    }
    return unknown.empty() ? last.free : FreeSet(unknown, calibration_->table.size());
  }
  /// Of some of the fitted samples, by number among them; nullopt if they cannot be fitted.
  /// @param free  of the last step
  [[nodiscard]] std::optional<Refit> of(const std::vector<std::size_t>& kept,
                                        const FreeSet& free) const {
    if (!calibration_) return std::nullopt;
    Calibration calibration = with_samples(*calibration_, some_);
    calibration.steps.back().free = free;
    std::vector<Sample> list = some_;
    std::set<int> others;
    for (int i = 0; i < static_cast<int>(some_.size()); ++i) others.insert(i);
    for (const std::size_t i : kept) others.erase(static_cast<int>(i));
    try {
      exclude(calibration, others, list);
    } catch (const std::invalid_argument&) {
      return std::nullopt;
    }
    return solved(calibration);
  }
  /// With suspects undone, one after the other; nullopt if that cannot be fitted.
  [[nodiscard]] std::optional<Refit> without(const std::vector<const Suspect*>& suspects) const {
    const auto other = assembled_without(suspects);
    return other ? solved(*other) : std::nullopt;
  }
  /// The cost with suspects undone, roughly: where only poses that nobody knows are fitted, to a few samples, or else after
  /// a few iterations.  It takes a tenth of the time of without(), and chooses what is worth that.  nullopt if that cannot
  /// be fitted, or in several steps.
  [[nodiscard]] std::optional<double> rough_cost(
      const std::vector<const Suspect*>& suspects) const {
    const auto other = assembled_without(suspects);
    if (!other || other->steps.size() != 1) return std::nullopt;
    const CalibrationStep& step = other->steps.front();
    std::vector<UnknownFrame> frames = step.unknown_frames;
    std::erase_if(frames, [](const UnknownFrame& frame) { return frame.has_guess; });
    const AnyProblem& few = step.excerpt ? *step.excerpt : *step.problem;
    Eigen::VectorXd at = other->table.values();
    for (const auto& [parameter, value] : step.assignments) at(parameter) = value;
    const ParameterValues values(std::span<const double>(
        from_ != nullptr ? other->begin.data() : at.data(), static_cast<std::size_t>(at.size())));
    constexpr PoseSearch kRoughly{.starts = 12, .rounds = 1, .first = 2, .kept = 3};
    double cost = cost_of_frames(few, frames, values, kRoughly);
    if (std::isfinite(cost)) return cost;
    constexpr int kRough = 8;  // iterations
    cost = cost_after(*step.problem->evaluator(step.free, 1), values, kRough);
    if (!std::isfinite(cost) && step.excerpt) {  // of lines of sight, which see behind a camera
      cost = cost_after(*step.excerpt->evaluator(step.free, 1), values, kRough);
    }
    return std::isfinite(cost) ? std::optional(cost) : std::nullopt;
  }
  /// The fitted samples with suspects undone.
  [[nodiscard]] std::vector<Sample> corrected(const std::vector<const Suspect*>& suspects) const {
    const bool needs_all =
        std::any_of(suspects.begin(), suspects.end(),
                    [](const Suspect* suspect) { return bool{suspect->correct_all}; });
    std::vector<Sample> samples =
        needs_all ? std::vector<Sample>(samples_.begin(), samples_.end()) : some_;
    for (const Suspect* suspect : suspects) {
      if (suspect->correct_all) suspect->correct_all(samples);
      if (suspect->correct) std::for_each(samples.begin(), samples.end(), suspect->correct);
    }
    return needs_all ? taken(samples) : samples;
  }

 private:
  [[nodiscard]] std::vector<Sample> taken(std::span<const Sample> all) const {
    std::vector<Sample> some;
    some.reserve(draw_.size());
    for (const std::size_t i : draw_) some.push_back(all[i]);
    return some;
  }
  [[nodiscard]] std::optional<Calibration> assembled(const Config& config,
                                                     std::span<const Sample> some) const {
    constexpr int kEnough = 40;  // iterations; what fits is found in far fewer
    Diagnostics quiet;
    Calibration calibration = assemble(config, robot_, some, quiet);
    for (CalibrationStep& step : calibration.steps) {
      step.max_num_iterations = std::min(step.max_num_iterations, kEnough);
      if (from_ == nullptr) continue;
      step.unknown_frames.clear();
      step.assignments.clear();
    }
    for (int i = 0; from_ != nullptr && i < calibration.table.size(); ++i) {
      calibration.begin.push_back((*from_)[calibration.table[i].name].value);
    }
    if (!quiet.errors.empty() || calibration.steps.empty()) return std::nullopt;
    return calibration;
  }
  [[nodiscard]] std::optional<Calibration> assembled_without(
      const std::vector<const Suspect*>& suspects) const {
    const std::vector<Sample> some = corrected(suspects);
    bool is_other = !calibration_;
    Config config = config_;
    for (const Suspect* suspect : suspects) {
      if (!suspect->correct_config) continue;
      suspect->correct_config(config);
      is_other = true;
    }
    return is_other ? assembled(config, some) : replaced(some);
  }
  /// The calibration with other numbers in the fitted samples; nullopt if they cannot be fitted.
  [[nodiscard]] std::optional<Calibration> replaced(std::span<const Sample> some) const {
    if (!calibration_) return std::nullopt;
    try {
      return with_samples(*calibration_, some);
    } catch (const SampleError&) {
      return std::nullopt;
    }
  }
  /// nullopt if the fit is not finite.
  [[nodiscard]] std::optional<Refit> solved(const Calibration& calibration) const {
    const CalibrationResult result = solve_(calibration);
    if (result.steps.empty() || !std::isfinite(result.steps.back().final_cost)) return {};
    const CalibrationStep& last = calibration.steps.back();
    Refit fit{result.steps.back().final_cost, result.blocks, result.table,
              robot_size(*last.problem)};
    for (const int p : last.free.parameters()) {
      const double change = change_of(result.table[p]);
      const Limits limits = plausible_change(last, p);
      fit.implausible += limits.exceeded(std::abs(change)) ? 1 : 0;
      fit.strain += change * change / (limits.care * limits.care);
    }
    return fit;
  }

  const Config& config_;
  const Robot& robot_;
  std::span<const Sample> samples_;
  const Calibrator& solve_;
  const ParameterTable* from_;
  std::vector<std::size_t> draw_;
  std::vector<Sample> some_;
  std::optional<Calibration> calibration_;
};

[[nodiscard]] inline Calibrator plain_calibrator() {
  return [](const Calibration& calibration) {
    return calibrate(calibration, {},
                     {.function_tolerance = 1e-7,  // far below what tells explanations apart
                      .threads = 1,
                      .search = kQuickSearch,
                      .hold_undetermined = false});  // what samples determine is compared
  };
}

/// "the samples can be solved, and the mean residual of 'hand_eye' is 0.11 mm", for the first block.
[[nodiscard]] inline std::string solved_text(const Refit& after) {
  std::string text = "the samples can be solved";
  for (const BlockStatistics& block : after.blocks) {
    if (!is_distance(block)) continue;
    return text + fmt::format(", and the mean residual of '{}' is {}", block.name,
                              residual_text(block.after.mean, block.unit));
  }
  return text;
}

/// "the mean residual of 'hand_eye' falls from 93 mm to 0.11 mm", for the block that falls most;
/// for a prior only if no other falls.
[[nodiscard]] inline std::string fall_of(const Refit& before, const Refit& after) {
  std::string text = fmt::format("the cost falls from {:.3g} to {:.3g}", before.cost, after.cost);
  double most = 1.0;
  for (const BlockStatistics& block : before.blocks) {
    if (!is_distance(block) && block.type != PoseToPose::kType) continue;
    for (const BlockStatistics& same : after.blocks) {
      const double ratio = block.after.mean / std::max(same.after.mean, 1e-300);
      if (same.name != block.name || !(ratio > most)) continue;
      most = ratio;
      text = fmt::format("the mean residual of '{}' falls from {} to {}", block.name,
                         residual_text(block.after.mean, block.unit),
                         residual_text(same.after.mean, same.unit));
    }
  }
  return text;
}

}  // namespace kinecal::detail
