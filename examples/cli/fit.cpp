// SPDX-License-Identifier: Apache-2.0
#include "fit.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/check_offsets.hpp"
#include "kinecal/config/doubts/likely_causes.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/trust/capture_causes.hpp"
#include "kinecal/trust/ruined.hpp"

namespace kinecal::cli {
std::vector<BlockConfig*> blocks_to_estimate(Config& config) {
  std::vector<BlockConfig*> all;
  for (StepConfig& step : config.steps) {
    std::vector<BlockConfig*> without;
    for (BlockConfig& block : step.error_blocks) {
      if (block.param.empty() && !block.sigma) without.push_back(&block);
    }
    for (BlockConfig* block : without) {
      if (without.size() > 1 || block->loss.type != "none") all.push_back(block);
    }
  }
  return all;
}

bool take_estimates(const Findings& findings, const std::vector<BlockConfig*>& blocks) {
  bool changed = false;
  for (BlockConfig* block : blocks) {
    const BlockNoise* noise =
        detail::of_block(findings.assessments, &Assessment::noise, block->name);
    if (noise == nullptr || !(noise->robust > 0.0)) continue;
    constexpr double kStays = 0.01;
    const double before = block->estimated_sigma.value_or(1.0);
    changed = changed || std::abs(noise->robust - before) > kStays * before;
    block->estimated_sigma = noise->robust;
  }
  return changed;
}

namespace {

constexpr const char* kExcluded = "--exclude";  ///< why a user left a sample out

/// The samples that are used, by number from 0, and those that are not.
class Selection {
 public:
  explicit Selection(const std::vector<Sample>& all) : all_(all) {}

  void leave_out(int sample, const std::string& why) {
    const auto s = static_cast<std::size_t>(sample);
    left_out_.push_back({sample + 1, all_[s].source, why});
    left_.insert(sample);
  }
  [[nodiscard]] std::vector<int> used() const {
    std::vector<int> numbers;
    for (int i = 0; i < static_cast<int>(all_.size()); ++i) {
      if (!left_.contains(i)) numbers.push_back(i);
    }
    return numbers;
  }
  [[nodiscard]] const std::vector<LeftOutSample>& left_out() const { return left_out_; }

 private:
  const std::vector<Sample>& all_;
  std::set<int> left_;
  std::vector<LeftOutSample> left_out_;
};

Fit fit_samples(const Input& input, const Config& config, const Selection& selection,
                const CalibrateOptions& options, const Progress& progress,
                const SolveOptions& solving) {
  Fit fitted;
  std::vector<int> numbers;
  for (const int i : selection.used()) {
    fitted.samples.push_back(input.samples[static_cast<std::size_t>(i)]);
    numbers.push_back(i + 1);
  }
  Diagnostics diagnostics;  // warnings have been printed
  fitted.calibration = assemble(config, input.robot, fitted.samples, diagnostics);
  diagnostics.throw_if_errors();
  AssessOptions assessing;
  assessing.meter = solving.meter;
  assessing.folds = options.folds > 0 ? options.folds : static_cast<int>(fitted.samples.size());
  fitted.findings = find(input.robot, fitted.calibration,
                         kinecal::calibrate(fitted.calibration, progress, solving), fitted.samples,
                         assessing, input.diagnostics.doubts);
  fitted.findings.numbers = std::move(numbers);
  for (const ModelConfig& model : detail::models_of(config)) {
    if (model.image == ImageKind::automatic) continue;
    fitted.findings.images[model.name] = model.image == ImageKind::raw ? "raw" : "rectified";
  }
  fitted.findings.left_out = selection.left_out();
  return fitted;
}

/// Fits, and fits again with the noise of each block that has no sigma in its place, until it stays.
Fit fit_with_estimates(const Input& input, const Selection& selection,
                       const CalibrateOptions& options, const Progress& progress,
                       const SolveOptions& solving) {
  Config config = input.config;
  const std::vector<BlockConfig*> blocks = blocks_to_estimate(config);
  Fit fitted = fit_samples(input, config, selection, options, progress, solving);
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds && fitted.findings.result.converged; ++round) {
    if (!take_estimates(fitted.findings, blocks)) break;
    fitted = fit_samples(input, config, selection, options, progress, solving);
  }
  return fitted;
}

/// Adds likely causes to the samples that were left out by the rule, and to those that are still bad.
void add_capture_causes(const Input& input, Fit& fitted) {
  Findings& findings = fitted.findings;
  if (!findings.result.converged || findings.assessments.empty()) return;
  const Assessment& last = findings.assessments.back();
  const Eigen::VectorXd values = findings.result.table.values();
  const auto make = [&] {
    return empty_problem(input.config, input.config.steps.back(), input.robot,
                         findings.result.table, fitted.samples);
  };
  const auto cause = [&](const Sample& sample) {
    return capture_cause(make, {values.data(), static_cast<std::size_t>(values.size())}, last.noise,
                         sample);
  };
  for (LeftOutSample& sample : findings.left_out) {
    if (sample.why == kExcluded) continue;
    const std::string why = cause(input.samples[static_cast<std::size_t>(sample.number - 1)]);
    if (!why.empty()) sample.why += "; likely cause: " + why;
  }
  for (const CaptureError& error : last.captures) {
    if (!error.bad) continue;
    const std::string why = cause(fitted.samples[static_cast<std::size_t>(error.sample)]);
    if (!why.empty()) findings.causes[error.sample] = why;
  }
}

}  // namespace

Fit fit(const Input& input, const CalibrateOptions& options, const Progress& progress,
        const SolveOptions& solving) {
  Selection selection(input.samples);
  for (const int number : std::set<int>(options.exclude.begin(), options.exclude.end())) {
    if (number < 1 || number > static_cast<int>(input.samples.size())) {
      throw InputError(fmt::format("--exclude: no sample {}; there are samples 1 to {}", number,
                                   input.samples.size()));
    }
    selection.leave_out(number - 1, kExcluded);
  }
  const auto again = [&] {
    return fit_with_estimates(input, selection, options, progress, solving);
  };
  const auto last_of = [&](const Fit& fitted) -> const Assessment* {
    const Findings& found = fitted.findings;
    const bool usable =
        !options.keep_outliers && found.result.converged && !found.assessments.empty();
    return usable ? &found.assessments.back() : nullptr;
  };
  const int excluded = static_cast<int>(selection.left_out().size());
  Fit fitted = fit_without_ruined(again, last_of, [&](const Fit& last, const CaptureError& ruined) {
    const Findings& found = last.findings;
    selection.leave_out(found.numbers[static_cast<std::size_t>(ruined.sample)] - 1,
                        capture_text(ruined, found.assessments.back()));
  });
  judge_left_out(static_cast<int>(selection.left_out().size()) - excluded,
                 static_cast<int>(input.samples.size()) - excluded, fitted.findings.judgement);
  add_capture_causes(input, fitted);
  return fitted;
}

void add_causes(const Input& input, Fit& fitted) {
  Findings& findings = fitted.findings;
  if (findings.result.converged) {
    Diagnostics offsets;
    check_offsets({input.config, input.robot, input.urdf_text, input.urdf, fitted.samples,
                   fitted.calibration},
                  findings.result.table, offsets);
    for (const std::string& error : offsets.errors) {
      findings.judgement.add(Grade::do_not_use, error);
    }
  }
  const bool bad = !findings.result.converged || findings.assessments.empty() ||
                   fits_badly(findings.assessments.back());
  if (bad) {
    for (const std::string& cause : likely_causes(input.config, input.robot, fitted.samples)) {
      findings.judgement.add(Grade::do_not_use, "likely cause: " + cause);
    }
  } else {
    for (const std::string& scale :
         wrong_scales(input.config, input.robot, fitted.samples, findings.result.table)) {
      findings.judgement.add(Grade::use_with_care, scale + "; are its lengths right?");
    }
  }
}

}  // namespace kinecal::cli
