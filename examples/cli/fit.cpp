// SPDX-License-Identifier: Apache-2.0
#include "fit.hpp"

#include <fmt/core.h>

#include <utility>

#include "kinecal/config/doubts/used_joints.hpp"

namespace kinecal::cli {

std::map<std::string, std::string> images_of(const Config& config) {
  std::map<std::string, std::string> images;
  for (const ModelConfig& model : detail::models_of(config)) {
    if (model.image == ImageKind::automatic) continue;
    images[model.name] = model.image == ImageKind::raw ? "raw" : "rectified";
  }
  return images;
}

std::map<std::string, std::string> lenses_of(const Config& config) {
  std::map<std::string, std::string> lenses;
  for (const ModelConfig& model : detail::models_of(config)) {
    if (!model.lens.empty() && model.image != ImageKind::rectified) lenses[model.name] = model.lens;
  }
  return lenses;
}

Fit fit(const Input& input, Calibration calibration, const CalibrateOptions& options,
        const Progress& progress, const SolveOptions& solving) {
  ProcedureOptions procedure{.solving = solving,
                             .folds = options.folds,
                             .keep_outliers = options.keep_outliers,
                             .exclude = {},
                             .doubts = input.diagnostics.doubts,
                             .refutable = input.diagnostics.refutable,
                             .progress = progress};
  for (const int number : options.exclude) {
    if (number < 1 || number > std::ssize(input.samples)) {
      throw InputError(fmt::format("--exclude: no sample {}; there are samples 1 to {}", number,
                                   input.samples.size()));
    }
    procedure.exclude[number - 1] = "--exclude";
  }
  Fit fitted{std::move(calibration), {}, {}, {}};
  JudgedResult judged = calibrate_and_judge(fitted.calibration, input.samples, procedure);
  fitted.samples = used_samples(judged, input.samples);
  const AnyProblem& problem = *fitted.calibration.steps.back().problem;
  for (std::size_t s = 0; s < problem.poses_of_samples().size(); ++s) {
    for (std::size_t f = 0; f < problem.own_poses().size(); ++f) {
      fitted.samples[s].poses[problem.own_poses()[f]] = problem.poses_of_samples()[s][f];
    }
  }
  for (const LeftOutSample& left : judged.left_out) {
    fitted.left_out.push_back(input.samples[static_cast<std::size_t>(left.number - 1)]);
  }
  fitted.findings = findings_of(input.robot, fitted.calibration, std::move(judged), fitted.samples);
  fitted.findings.images = images_of(input.config);
  fitted.findings.lenses = lenses_of(input.config);
  fitted.findings.has_own_poses = !input.config.per_sample.empty();
  return fitted;
}

}  // namespace kinecal::cli
