// Definitions of judge_shards.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/judge_shards.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/solve/shards.hpp"
#include "kinecal/trust/assess_shards.hpp"
#include "kinecal/trust/estimated_noise.hpp"
#include "kinecal/trust/judge_files.hpp"
#include "kinecal/trust/judge_input.hpp"
#include "kinecal/trust/systematic/folded_lens.hpp"

namespace kinecal {

namespace detail {
namespace {

// Lenses that fold over, of samples in shards.

/// Numbers of each sensor: where its lens folds over, the farthest corner of its image and the farthest feature.
[[nodiscard]] std::vector<double> packed(const std::vector<FoldedLens>& folded,
                                         const std::vector<MountedSensor>& sensors) {
  std::vector<double> all;
  for (const MountedSensor& mounted : sensors) {
    FoldedLens of{mounted.mount().name, HUGE_VAL};
    for (const FoldedLens& fold : folded) {
      if (fold.sensor == of.sensor) of = fold;
    }
    all.insert(all.end(), {of.radius, of.corner, of.farthest});
  }
  return all;
}

/// folded_lenses() of the samples of all shards.
/// @param samples_of  reads the samples of a shard: only where a lens is free
[[nodiscard]] std::vector<FoldedLens> shard_folds(
    const Shards& shards, const FreeSet& free, ParameterValues values,
    const std::function<std::vector<Sample>(int shard)>& samples_of) {
  const AnyProblem& problem = *shards.problem;
  const std::vector<MountedSensor>& sensors = problem.sensors();
  const bool frees = std::any_of(sensors.begin(), sensors.end(),
                                 [&](const MountedSensor& one) { return frees_lens(one, free); });
  if (!frees) return {};
  const auto numbers_of = [&](int shard) {
    return packed(folded_lenses(problem, free, values, samples_of(shard)), sensors);
  };
  std::vector<FoldedLens> folded;
  for (const MountedSensor& one : sensors) folded.push_back({one.mount().name, HUGE_VAL});
  for (const auto& of : numbers_of_shards(shards, name_at("folds", free, values), numbers_of)) {
    for (std::size_t s = 0; s < folded.size(); ++s) {
      folded[s].radius = std::min(folded[s].radius, of.at(3 * s));
      folded[s].corner = std::max(folded[s].corner, of.at(3 * s + 1));
      folded[s].farthest = std::max(folded[s].farthest, of.at(3 * s + 2));
    }
  }
  std::erase_if(folded, [](const FoldedLens& fold) { return !std::isfinite(fold.radius); });
  return folded;
}

/// Adds what needs samples at once, of a draw, to the assessment of all.
void add_drawn(const Assessment& drawn, Assessment& all) {
  Assessment whole = drawn;
  for (std::size_t t = 0; t < std::min(whole.noise.size(), all.noise.size()); ++t) {
    all.noise[t].repeats = whole.noise[t].repeats;
    all.noise[t].repeats_freedom = whole.noise[t].repeats_freedom;
    all.noise[t].along = whole.noise[t].along;
    all.noise[t].across = whole.noise[t].across;
    all.noise[t].distance = whole.noise[t].distance;
    all.noise[t].angle = whole.noise[t].angle;
    all.noise[t].own = whole.noise[t].own;
    all.noise[t].own_freedom = whole.noise[t].own_freedom;
  }
  whole.observability = std::move(all.observability);
  whole.noise = std::move(all.noise);
  whole.parameters = std::move(all.parameters);
  whole.at_bound = std::move(all.at_bound);
  whole.uncertainty = std::move(all.uncertainty);
  whole.weak = std::move(all.weak);
  whole.folded = std::move(all.folded);
  whole.compared = std::move(all.compared);
  whole.rows = all.rows;
  whole.used = all.used;
  whole.samples = all.samples;
  all = std::move(whole);
}

/// The procedure on samples in shards.
class ShardProcedure {
 public:
  ShardProcedure(const ShardedCalibration& calibration, const ProcedureOptions& options)
      : calibration_(calibration), options_(options), noise_(calibration.calibration) {}

  [[nodiscard]] JudgedResult run() {
    const auto noise_of = [](const JudgedResult& judged) {
      EstimatedNoise::OfSteps noise;
      if (!judged.result.converged) return noise;
      for (const Assessment& step : judged.assessments) noise.push_back(step.noise);
      return noise;
    };
    JudgedResult judged = noise_.settle(
        calibration_.calibration, [&] { return fit(); }, noise_of);
    judged.judgement = judge(calibration_.calibration, judged.result, judged.assessments,
                             options_.doubts, options_.refutable);
    judge_files(found_, calibration_.names, judged.judgement);
    judged.unused = judge_input(calibration_.calibration, options_.doubts, judged.judgement);
    return judged;
  }

 private:
  [[nodiscard]] const CalibrationStep& step(std::size_t s) const {
    return calibration_.calibration.steps[s];
  }

  [[nodiscard]] ShardExchange exchange(const std::string& prefix) const {
    if (!calibration_.exchange) return {};
    return [this, prefix](const std::string& what, const NumbersOfShard& numbers_of) {
      return calibration_.exchange(prefix + what, numbers_of);
    };
  }

  /// Sigmas of the steps' problems, for the shards that are in memory.
  void set_sigmas() {
    for (auto& [key, problem] : problems_) {
      const AnyProblem& changed = *step(key.first).problem;
      for (int t = 0; t < changed.num_terms(); ++t) {
        problem->set_sigma(t, changed.term(t).sigma);
      }
    }
  }

  /// A step's problem with the samples of a shard.  Few samples are kept in memory.
  [[nodiscard]] std::shared_ptr<const AnyProblem> problem(std::size_t s, int shard) {
    constexpr int kKept = 100000;  // samples
    const auto known = problems_.find({s, shard});
    if (known != problems_.end()) return known->second;
    std::shared_ptr<AnyProblem> made = step(s).problem->without_samples();
    for (const Sample& sample : calibration_.read(shard)) made->add_sample(sample);
    int kept = made->num_samples();
    for (const auto& [key, one] : problems_) kept += one->num_samples();
    if (kept <= kKept) problems_[{s, shard}] = made;
    return made;
  }

  [[nodiscard]] JudgedResult fit() {
    set_sigmas();
    std::string prefix = "step";
    for (const double sigma : noise_.sigmas(calibration_.calibration)) {
      char exact[40];
      (void)std::snprintf(exact, sizeof exact, " %.17g", sigma);
      prefix += exact;
    }
    const Eigen::VectorXd table = calibration_.calibration.table.values();
    const std::vector<double> initial(table.begin(), table.end());
    std::vector<double> guess = initial;
    if (calibration_.drawn != nullptr) {
      const Eigen::VectorXd start = calibration_.drawn->result.table.values();
      guess.assign(start.begin(), start.end());
    }
    JudgedResult judged;
    judged.result.table = calibration_.calibration.table;
    std::vector<double> values = initial;
    for (std::size_t s = 0; s < calibration_.calibration.steps.size(); ++s) {
      const std::string of_step = prefix + " " + std::to_string(s) + " ";
      if (!solve(s, of_step, initial, guess, values, judged)) break;
    }
    for (int i = 0; i < judged.result.table.size(); ++i) {
      judged.result.table[i].initial = initial[static_cast<std::size_t>(i)];
      judged.result.table[i].value = values[static_cast<std::size_t>(i)];
    }
    return judged;
  }

  /// @param values  in: where the step before ended; out: where this one did
  /// @returns  whether it converged
  bool solve(std::size_t s, const std::string& prefix, const std::vector<double>& initial,
             const std::vector<double>& guess, std::vector<double>& values, JudgedResult& judged) {
    const FreeSet& free = calibration_.free[s];
    const std::unique_ptr<AnyProblem> bare = step(s).problem->without_samples();
    Shards shards{bare.get(),
                  static_cast<int>(calibration_.names.size()),
                  calibration_.num_samples,
                  calibration_.num_residuals[s],
                  [this, s](int shard) { return problem(s, shard); },
                  exchange(prefix)};
    for (const auto& [parameter, value] : step(s).assignments) {
      values[static_cast<std::size_t>(parameter)] = value;
    }
    const std::vector<double> reference = values;
    for (const int p : free.parameters()) {
      values[static_cast<std::size_t>(p)] = guess[static_cast<std::size_t>(p)];
    }
    SolveOptions solving = options_.solving;
    solving.max_num_iterations = step(s).max_num_iterations;
    StepResult solved = solve_shards(shards, free, values, reference, solving);
    solved.name = step(s).name;
    if (calibration_.drawn != nullptr && s < calibration_.drawn->result.steps.size()) {
      solved.starts = calibration_.drawn->result.steps[s].starts;
    }
    add_step(std::move(solved), free, judged.result);
    if (!judged.result.converged) return false;
    ShardAssessment found =
        assess_shards(shards, free, initial, values, *step(s).problem, calibration_.samples);
    found.assessment.step = step(s).name;
    found.assessment.folded = shard_folds(shards, free, values, calibration_.read);
    if (calibration_.drawn != nullptr && s < calibration_.drawn->assessments.size()) {
      add_drawn(calibration_.drawn->assessments[s], found.assessment);
    }
    judged.assessments.push_back(std::move(found.assessment));
    merge_statistics(judged.result.blocks, std::move(found.blocks));
    found_ = std::move(found);
    return true;
  }

  const ShardedCalibration& calibration_;
  const ProcedureOptions& options_;
  EstimatedNoise noise_;
  std::map<std::pair<std::size_t, int>, std::shared_ptr<AnyProblem>> problems_;
  ShardAssessment found_;  ///< of the last step
};

}  // namespace
}  // namespace detail

JudgedResult calibrate_and_judge(const ShardedCalibration& calibration,
                                 const ProcedureOptions& options) {
  return detail::ShardProcedure(calibration, options).run();
}

}  // namespace kinecal
