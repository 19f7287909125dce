// Definitions of choose_images.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/choose_images.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/some_samples.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/evaluation/any_evaluator.hpp"

namespace kinecal {

namespace detail {
namespace {

// How well the samples fit a camera's image as raw, and as rectified.

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
[[nodiscard]] bool has_image(const ModelConfig& model) {
  const SensorEntry* entry = entry_of(model);
  return entry != nullptr && entry->has_image;
}

/// Sets the image of a camera in the steps that do not give it.
void set_image(Config& config, const std::string& camera, ImageKind image) {
  for (StepConfig& step : config.steps) {
    for (ModelConfig& model : step.models) {
      const bool open = has_image(model) && model.image == ImageKind::automatic;
      if (open && model.name == camera) model.image = image;
    }
  }
}

/// Adds a loss to pixel error blocks, so that bad captures do not decide.
void add_losses(Config& config, std::span<const Sample> samples) {
  constexpr double kScale = 2.0;  // pixels
  for (StepConfig& step : config.steps) {
    for (BlockConfig& block : step.error_blocks) {
      const BlockEntry* entry = entry_of(block);
      if (entry == nullptr || entry->unit != "px" || block.loss.type != "none") continue;
      block.loss = {"cauchy", kScale / stated_sigma(block, step, samples).value_or(1.0)};
    }
  }
}

/// The fit with an image of this kind; nullopt if absent.
[[nodiscard]] std::optional<ImageFit> fit_image(Config config, const Robot& robot,
                                                std::span<const Sample> samples,
                                                const std::string& camera, ImageKind image) {
  constexpr int kEnough = 100;  // iterations
  set_image(config, camera, image);
  add_losses(config, samples);
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
[[nodiscard]] ImageKind preferred(const std::optional<ImageFit>& raw,
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

/// The choices that a camera's observations allow.
struct ImageOptions {
  bool seen = false;      ///< there are observations
  bool differ = false;    ///< the choices differ
  bool bends = false;     ///< a coefficient of the distortion is not zero
  double turn = 0.0;      ///< angle of R, radians
  std::string no_raw;     ///< why raw is impossible
  std::string lens;       ///< the distortion model, if that is why
  bool rectified = true;  ///< is possible
};

/// True if only the distortion keeps a camera_info from describing a raw image.
[[nodiscard]] bool is_only_lens(const AnySensor& as_raw, Observation seen) {
  seen.camera->d.clear();
  seen.camera->distortion_model.clear();
  try {
    (void)as_raw.settings(seen);
    return true;
  } catch (const SettingsError&) {
    return false;
  }
}

[[nodiscard]] ImageOptions image_options(std::span<const Sample> samples, const ModelConfig& camera,
                                         const SensorEntry& entry) {
  const std::shared_ptr<const AnySensor> as_raw =
                                             entry.make({ImageKind::raw, options_of(camera).lens}),
                                         as_rectified = entry.make(
                                             {ImageKind::rectified, options_of(camera).lens});
  ImageOptions options;
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera.name);
    if (seen == nullptr || !seen->camera) continue;
    options.seen = true;
    const CameraInfo& info = *seen->camera;
    for (const double d : info.d) options.bends = options.bends || d != 0.0;
    const double trace = info.r[0] + info.r[4] + info.r[8];
    if (trace > 1.0) options.turn = std::acos(std::min(1.0, 0.5 * (trace - 1.0)));
    std::vector<double> raw, rectified;
    try {
      rectified = as_rectified->settings(*seen);
    } catch (const SettingsError&) {
      options.rectified = false;
    }
    try {
      raw = as_raw->settings(*seen);
    } catch (const SettingsError& e) {
      options.no_raw = e.what();
      if (is_only_lens(*as_raw, *seen)) options.lens = info.distortion_model;
    }
    options.differ = options.differ || raw != rectified;
  }
  return options;
}

/// Decides for one camera.
void choose_image(Config& config, const Robot& robot, std::span<const Sample> samples,
                  const ModelConfig& camera, const ImageOptions& options,
                  Diagnostics& diagnostics) {
  const std::string sensor = fmt::format("sensor '{}'", camera.name);
  if (!options.no_raw.empty()) {
    if (!options.rectified || !options.bends) return;  // an error, or P as always
    set_image(config, camera.name, ImageKind::rectified);
    if (options.lens.empty()) {
      diagnostics.note(camera.place,
                       fmt::format("{}: image taken as rectified; {}", sensor, options.no_raw));
    } else if (!lens_named(options.lens).empty()) {
      diagnostics.error(camera.place,
                        fmt::format("{}: its lens: {}; correct its camera_info, or write 'image: "
                                    "rectified' in the model if its pixels are of rectified images",
                                    sensor, options.no_raw));
    } else {  // raw pixels taken as rectified would be wrong by all of the distortion
      diagnostics.error(
          camera.place,
          fmt::format("{}: its lens has the distortion model '{}', which raw images cannot have "
                      "here, and the configuration does not say that its pixels are of rectified "
                      "images; rectify the images and write 'image: rectified' in the model, or "
                      "give it another 'lens' and free its coefficients",
                      sensor, options.lens));
    }
    return;
  }
  if (!options.rectified || !options.differ) return;
  const std::vector<Sample> some = some_of(samples);
  const auto raw = fit_image(config, robot, some, camera.name, ImageKind::raw);
  const auto rectified = fit_image(config, robot, some, camera.name, ImageKind::rectified);
  const ImageKind image = preferred(raw, rectified);
  if (image == ImageKind::automatic) return;
  set_image(config, camera.name, image);
  const auto text = [](const std::optional<ImageFit>& fit) {
    return fit ? fmt::format("{:.2g} px", fit->median()) : "does not fit";
  };
  diagnostics.note(camera.place,
                   fmt::format("{}: image raw {}, rectified {}: taken as {}", sensor, text(raw),
                               text(rectified), image == ImageKind::raw ? "raw" : "rectified"));
}

/// A raw image is in the frame of the lens, but ROS uses a camera's frame for its rectified image.
void warn_of_turned_image(const Config& config, const ModelConfig& camera,
                          const ImageOptions& options, Diagnostics& diagnostics) {
  constexpr double kTurned = 1e-4;
  if (!(options.turn > kTurned) || !options.no_raw.empty()) return;
  for (const StepConfig& step : config.steps) {
    for (const ModelConfig& model : step.models) {
      if (model.name != camera.name) continue;
      const bool raw =
          model.image == ImageKind::raw || (model.image == ImageKind::automatic && options.bends);
      if (!raw) return;
    }
  }
  diagnostics.warning(
      camera.place,
      fmt::format("sensor '{}': the image is raw, so frame '{}' is calibrated as that of the lens; "
                  "R of camera_info turns the rectified image, for which ROS takes it, by {:.2g} "
                  "degrees; calibrate with rectified images to have that frame",
                  camera.name, camera.frame, options.turn * 180.0 / std::numbers::pi));
}

}  // namespace
}  // namespace detail

void choose_images(Config& config, const Robot& robot, std::span<const Sample> samples,
                   Diagnostics& diagnostics) {
  for (const ModelConfig& camera : detail::models_of(config)) {
    if (!detail::has_image(camera)) continue;
    ImageKind given = ImageKind::automatic;
    for (const StepConfig& step : config.steps) {
      for (const ModelConfig& model : step.models) {
        if (model.name == camera.name && given == ImageKind::automatic) given = model.image;
      }
    }
    const detail::ImageOptions options = detail::image_options(samples, camera, *entry_of(camera));
    const std::string coefficient = detail::free_coefficient(config, camera);
    if (given == ImageKind::rectified && !coefficient.empty()) {
      diagnostics.error(camera.place,
                        fmt::format("sensor '{}': '{}' is free, but its images are rectified and "
                                    "have no distortion; write 'image: raw', or hold it",
                                    camera.name, coefficient));
    }
    if (given != ImageKind::automatic) {
      detail::set_image(config, camera.name, given);
    } else if (!coefficient.empty()) {
      detail::set_image(config, camera.name, ImageKind::raw);
    } else if (options.seen) {
      detail::choose_image(config, robot, samples, camera, options, diagnostics);
    }
    detail::warn_of_turned_image(config, camera, options, diagnostics);
  }
}

}  // namespace kinecal
