// How well the samples fit a camera's image as raw, and as rectified.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"

namespace kinecal::detail {

/// Distances of a camera's features from a fit, pixels.
struct ImageFit {
  std::vector<std::vector<double>> samples;  ///< of each sample, feature after feature
  int components = 2;                        ///< residuals of a feature

  [[nodiscard]] double median() const {
    std::vector<double> all;
    for (const auto& sample : samples) all.insert(all.end(), sample.begin(), sample.end());
    if (all.empty()) return HUGE_VAL;
    const auto middle = all.begin() + std::ssize(all) / 2;
    std::nth_element(all.begin(), middle, all.end());
    return *middle;
  }
};

/// True if a model is of a type with the key `image`.
[[nodiscard]] inline bool has_image(const ModelConfig& model) {
  const SensorEntry* entry = entry_of(model);
  return entry != nullptr && entry->has_image;
}

/// Sets the image of a camera in the steps that do not give it.
inline void set_image(Config& config, const std::string& camera, ImageKind image) {
  for (StepConfig& step : config.steps) {
    for (ModelConfig& model : step.models) {
      const bool open = has_image(model) && model.image == ImageKind::automatic;
      if (open && model.name == camera) model.image = image;
    }
  }
}

/// Adds a loss to pixel error blocks, so that bad captures do not decide.
inline void add_losses(Config& config) {
  constexpr double kScale = 2.0;  // pixels
  for (StepConfig& step : config.steps) {
    for (BlockConfig& block : step.error_blocks) {
      const BlockEntry* entry = entry_of(block);
      if (entry == nullptr || entry->unit != "px" || block.loss.type != "none") continue;
      block.loss = {"cauchy", kScale / block.sigma.value_or(1.0)};
    }
  }
}

/// The fit with an image of this kind; nullopt if absent.
[[nodiscard]] inline std::optional<ImageFit> fit_image(Config config, const Robot& robot,
                                                       std::span<const Sample> samples,
                                                       const std::string& camera, ImageKind image) {
  constexpr int kEnough = 100;  // iterations
  set_image(config, camera, image);
  add_losses(config);
  Diagnostics quiet;
  Calibration calibration = assemble(config, robot, samples, quiet);
  if (!quiet.errors.empty() || calibration.steps.empty()) return std::nullopt;
  for (CalibrationStep& step : calibration.steps) {
    step.max_num_iterations = std::min(step.max_num_iterations, kEnough);
  }
  const CalibrationResult result = calibrate(calibration);
  if (result.steps.empty() || !std::isfinite(result.steps.back().final_cost)) return std::nullopt;
  const Eigen::VectorXd values = result.table.values();
  ImageFit fit;
  fit.samples.resize(samples.size());
  for (const CalibrationStep& step : calibration.steps) {
    const AnyProblem& problem = *step.problem;
    const auto sees = [&](int sensor) {
      return problem.sensors()[static_cast<std::size_t>(sensor)].mount().name == camera;
    };
    const auto visit = [&](int term, int sample, const TermResiduals& rows) {
      const std::vector<int>& sensors = problem.term(term).sensors;
      if (std::none_of(sensors.begin(), sensors.end(), sees)) return;
      const int size = fit.components = problem.term(term).feature_size;
      for (Eigen::Index row = 0; row + size <= rows.residual.size(); row += size) {
        fit.samples[static_cast<std::size_t>(sample)].push_back(
            rows.residual.segment(row, size).norm());
      }
    };
    const std::span<const double> all(values.data(), static_cast<std::size_t>(values.size()));
    if (evaluate(problem, all, nullptr, visit)) return std::nullopt;
  }
  return fit;
}

/// The kind of image that the samples prefer: see choose_images.hpp.
[[nodiscard]] inline ImageKind preferred(const std::optional<ImageFit>& raw,
                                         const std::optional<ImageFit>& rectified) {
  if (!raw || !rectified) {
    return raw ? ImageKind::raw : rectified ? ImageKind::rectified : ImageKind::automatic;
  }
  constexpr double kRounding = 1e-6;  // pixels
  const double scale = std::max(kRounding, std::min(raw->median(), rectified->median()));
  const auto misfit = [&](const ImageFit& fit, std::size_t sample) {
    double sum = 0.0;
    for (const double r : fit.samples[sample]) sum += std::log1p((r / scale) * (r / scale));
    return 0.5 * (fit.components + 1) * sum;
  };
  constexpr double kMost = 5.0, kClear = 10.0;
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < raw->samples.size(); ++i) {
    if (raw->samples[i].empty()) continue;
    const double d = std::clamp(misfit(*raw, i) - misfit(*rectified, i), -kMost, kMost);
    sum += d;
    squares += d * d;
    count += 1.0;
  }
  const double sigmas = std::min(2.5, 0.9 * std::sqrt(count));  // few samples: nearly all agree
  if (!(std::abs(sum) > kClear && std::abs(sum) > sigmas * std::sqrt(squares))) {
    return ImageKind::automatic;
  }
  return sum > 0.0 ? ImageKind::rectified : ImageKind::raw;
}

}  // namespace kinecal::detail
