// Definitions of calibrate_and_judge.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/calibrate_and_judge.hpp"

#include <cstdio>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "kinecal/trust/captures/capture_causes.hpp"
#include "kinecal/trust/captures/jumps.hpp"
#include "kinecal/trust/captures/ruined.hpp"
#include "kinecal/trust/estimated_noise.hpp"
#include "kinecal/trust/judge_input.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The noise of the error blocks of each step; empty if the result has not converged, or ended with a point behind a camera.
[[nodiscard]] EstimatedNoise::OfSteps noise_of_steps(const Calibration& calibration,
                                                     const CalibrationResult& result) {
  EstimatedNoise::OfSteps noise;
  if (!result.converged) return noise;
  const Eigen::VectorXd values = result.table.values();
  try {
    for (std::size_t s = 0; s < result.steps.size(); ++s) {
      const CalibrationStep& step = calibration.steps[s];
      noise.push_back(noise_at(*step.problem, step.free,
                               {values.data(), static_cast<std::size_t>(values.size())}));
    }
  } catch (const std::domain_error&) {
    noise.clear();
  }
  return noise;
}

/// The procedure on one calibration.
class Procedure {
 public:
  Procedure(Calibration& calibration, std::span<const Sample> samples,
            const ProcedureOptions& options)
      : calibration_(calibration), all_(samples), options_(options), noise_(calibration) {
    numbers_.resize(samples.size());
    std::iota(numbers_.begin(), numbers_.end(), 1);
    used_.assign(samples.begin(), samples.end());
  }

  [[nodiscard]] JudgedResult run() {
    leave_out(options_.exclude);
    const auto excluded = std::ssize(left_out_);
    const auto last = [&](const JudgedResult& judged) -> const Assessment* {
      const bool usable =
          !options_.keep_outliers && judged.result.converged && !judged.assessments.empty();
      return usable ? &judged.assessments.back() : nullptr;
    };
    const auto fit_others = [&] {
      return fit_without_ruined(
          [&] { return fit(); }, last,
          [&](const JudgedResult& of, const std::vector<CaptureError>& ruined) {
            std::map<int, std::string> why;
            for (const CaptureError& error : ruined) {
              why[error.sample] = capture_text(error, of.assessments.back());
            }
            leave_out(why);
          });
    };
    JudgedResult judged = fit_others();
    // A fit that a jump led astray may have converged, at the bounds of its parameters.
    if (judged.judgement.verdict == Grade::do_not_use && !options_.keep_outliers) {
      if (const auto jumps = jumps_at_start(calibration_); !jumps.empty()) {
        leave_out(jumps);
        judged = fit_others();
      }
    }
    judge_left_out(static_cast<int>(std::ssize(left_out_) - excluded),
                   static_cast<int>(std::ssize(all_) - excluded), judged.judgement);
    judged.numbers = numbers_;
    judged.left_out = left_out_;
    add_causes(static_cast<std::size_t>(excluded), judged);
    return judged;
  }

 private:
  /// @param samples  by number in the problem, and why
  void leave_out(const std::map<int, std::string>& samples) {
    if (samples.empty()) return;
    std::set<int> left;
    for (const auto& [sample, why] : samples) {
      if (sample < 0 || sample >= std::ssize(used_)) {
        throw std::invalid_argument("no sample " + std::to_string(sample + 1) +
                                    "; there are samples 1 to " + std::to_string(used_.size()));
      }
      const auto s = static_cast<std::size_t>(sample);
      left_out_.push_back({numbers_[s], used_[s].source, why});
      left.insert(sample);
    }
    exclude(calibration_, left, used_);
    for (auto i = left.rbegin(); i != left.rend(); ++i) numbers_.erase(numbers_.begin() + *i);
  }

  /// Fits, and fits again with the noise of each block that has no sigma in its place, until it stays.  Judges the last fit.
  [[nodiscard]] JudgedResult fit() {
    noise_.reset(calibration_);
    const auto solved = [&] {
      return calibrate(calibration_, options_.progress, options_.solving);
    };
    const auto noise_of = [&](const CalibrationResult& result) {
      return noise_of_steps(calibration_, result);
    };
    CalibrationResult result = noise_.settle(calibration_, solved, noise_of);
    AssessOptions assessing;
    assessing.meter = options_.solving.meter;
    assessing.between = options_.between;
    assessing.folds = options_.folds > 0 ? options_.folds : static_cast<int>(used_.size());
    return judge_result(calibration_, std::move(result), used_, assessing, options_.doubts,
                        options_.refutable);
  }

  /// Adds likely causes to the samples that were left out as ruined, and to those that are still bad.
  void add_causes(std::size_t excluded, JudgedResult& judged) const {
    if (!judged.result.converged || judged.assessments.empty()) return;
    const Assessment& last = judged.assessments.back();
    const Eigen::VectorXd values = judged.result.table.values();
    const auto cause = [&](const Sample& sample) {
      return capture_cause(*calibration_.steps[judged.assessments.size() - 1].problem,
                           {values.data(), static_cast<std::size_t>(values.size())}, last.noise,
                           sample);
    };
    for (std::size_t i = excluded; i < judged.left_out.size(); ++i) {
      LeftOutSample& left = judged.left_out[i];
      const std::string why = cause(all_[static_cast<std::size_t>(left.number - 1)]);
      if (!why.empty()) left.why += "; likely cause: " + why;
    }
    for (const CaptureError& error : last.captures) {
      if (!error.bad) continue;
      const std::string why = cause(used_[static_cast<std::size_t>(error.sample)]);
      if (!why.empty()) judged.causes[error.sample] = why;
    }
  }

  Calibration& calibration_;
  std::span<const Sample> all_;
  const ProcedureOptions& options_;
  EstimatedNoise noise_;
  std::vector<Sample> used_;
  std::vector<int> numbers_;  ///< from 1, of those used
  std::vector<LeftOutSample> left_out_;
};

}  // namespace
}  // namespace detail

std::optional<double> JudgedResult::deviation(int parameter) const {
  for (auto step = assessments.rbegin(); step != assessments.rend(); ++step) {
    if (const auto found = step->deviation(parameter)) return found;
  }
  return std::nullopt;
}

JudgedResult calibrate_and_judge(Calibration& calibration, std::span<const Sample> samples,
                                 const ProcedureOptions& options) {
  return detail::Procedure(calibration, samples, options).run();
}

JudgedResult judge_result(const Calibration& calibration, CalibrationResult result,
                          std::span<const Sample> samples, const AssessOptions& options,
                          const std::vector<std::string>& doubts,
                          const std::vector<std::string>& refutable) {
  JudgedResult judged;
  judged.result = std::move(result);
  for (const Sample& sample : samples) judged.sources.push_back(sample.source);
  judged.numbers.resize(samples.size());
  std::iota(judged.numbers.begin(), judged.numbers.end(), 1);
  const std::vector<StepResult>& steps = judged.result.steps;
  if (judged.result.converged || (!steps.empty() && steps.back().iterations > 0)) {
    try {
      judged.assessments = assess(calibration, judged.result, samples, options);
    } catch (const std::domain_error&) {  // it ended with a point behind a camera: not converged
    }
  }
  judged.judgement = judge(calibration, judged.result, judged.assessments, doubts, refutable);
  judged.unused = judge_input(calibration, doubts, judged.judgement);
  return judged;
}

std::vector<Sample> used_samples(const JudgedResult& judged, std::span<const Sample> all) {
  std::vector<Sample> used;
  for (const int number : judged.numbers) used.push_back(all[static_cast<std::size_t>(number - 1)]);
  return used;
}

std::string capture_text(const CaptureError& error, const Assessment& assessment) {
  const BlockNoise& noise = assessment.noise[static_cast<std::size_t>(error.term)];
  const std::string block = "error block '" + noise.block + "': ";
  char times[48];
  constexpr double kMost =
      1e4;  // beyond it the noise is that of a few features, and the number says nothing
  if (error.times > kMost) {
    (void)std::snprintf(times, sizeof times, "over %.0f times the noise", kMost);
  } else {
    (void)std::snprintf(times, sizeof times, "%.1f times the noise", error.times);
  }
  constexpr double kAlike = 0.8;
  if (error.others > 0.0 && error.least > kAlike * error.distance) {
    return block + "all features are about " + reading(error.distance, noise.unit) + " off, " +
           times;
  }
  std::string text =
      block + error.feature.text() + " is " + reading(error.distance, noise.unit) + " off";
  if (error.others > 0.0) text += ", all others at most " + reading(error.others, noise.unit);
  return text + ", " + times;
}

}  // namespace kinecal
