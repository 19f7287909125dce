// Definitions of enough_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/enough_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/config/doubts/occurrences.hpp"

namespace kinecal::detail {

/// The source location of a step; the whole file if the configuration lacks the step.
[[nodiscard]] inline SourceLocation place_of_step(const Config& config, const std::string& name) {
  for (const StepConfig& step : config.steps) {
    if (step.name == name) return step.place;
  }
  return config.place;
}

/// Number of a step's free parameters that move links: offsets and axes of frames.
[[nodiscard]] inline std::size_t moving_parameters(const CalibrationStep& step,
                                                   const std::set<std::string>& own) {
  const auto& owners = step.problem->owners();
  const auto& free = step.free.parameters();
  return static_cast<std::size_t>(std::count_if(free.begin(), free.end(), [&](int p) {
    return !own.contains(owners[static_cast<std::size_t>(p)]);
  }));
}

void check_enough_samples(const Config& config, const Calibration& calibration,
                          std::size_t distinct, Diagnostics& diagnostics) {
  std::set<std::string> own;  // owners of parameters that move nothing
  for (const StepConfig& step : config.steps) {
    for (const ModelConfig& model : step.models) {
      own.insert(model.param_name.empty() ? model.name : model.param_name);
    }
    for (const BlockConfig& block : step.error_blocks) own.insert(block.name);
  }
  for (const CalibrationStep& step : calibration.steps) {
    const auto samples = static_cast<std::size_t>(step.problem->num_samples());
    const auto free = static_cast<std::size_t>(step.free.size());
    if (samples == 0 || free == 0) continue;
    const std::size_t unlike = std::min(distinct, samples);
    const auto all = static_cast<std::size_t>(step.problem->num_residuals());
    const std::size_t residuals = (all * unlike + samples - 1) / samples;
    const SourceLocation place = place_of_step(config, step.name);
    const std::string counts =
        fmt::format("step '{}' has {}, {} {}", step.name, counted(free, "free parameter"),
                    counted(unlike, "different sample"), unlike == 1 ? "gives" : "give");
    if (5 * free > 4 * residuals) {
      diagnostics.error(place, fmt::format("{} only {}: nearly any values fit; record more samples "
                                           "or free fewer parameters",
                                           counts, counted(residuals, "residual")));
    } else if (2 * free > residuals) {
      diagnostics.doubt(place, fmt::format("{} only {}, less than two for each parameter; record "
                                           "more samples or free fewer parameters",
                                           counts, counted(residuals, "residual")));
    } else if (const std::size_t moving = moving_parameters(step, own), numbers = 6 * unlike;
               2 * moving > numbers && step.problem->num_terms() > 0) {
      const std::string text = fmt::format(
          "{} {}, but a pose only has six numbers, and {} of the "
          "parameters move links; record more poses",
          counts, counted(residuals, "residual"), moving);
      if (moving > 6 && 5 * moving > 4 * numbers) {  // six are where one thing is
        diagnostics.error(place, text);
      } else {
        diagnostics.doubt(place, text);
      }
    }
  }
}

[[nodiscard]] inline bool has_usable_feature(const Observation& seen) {
  return std::any_of(seen.features.begin(), seen.features.end(),
                     [](const Feature& feature) { return feature.point.allFinite(); });
}

/// True if some error block finds all of its models in the sample.
[[nodiscard]] inline bool is_used(const Config& config, const Sample& sample) {
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      if (block.models.empty()) continue;
      if (std::all_of(block.models.begin(), block.models.end(), [&](const std::string& model) {
            const Observation* seen = sample.observation(model);
            return seen != nullptr && has_usable_feature(*seen);
          })) {
        return true;
      }
    }
  }
  return false;
}

void check_dropped_observations(const Config& config, std::span<const Sample> samples,
                                Diagnostics& diagnostics) {
  std::map<std::string, Occurrences> empty;
  std::map<std::string, std::size_t> with_features;
  Occurrences unused;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    for (const Observation& seen : samples[s].observations) {
      if (has_usable_feature(seen)) {
        ++with_features[seen.sensor];
      } else {
        empty[seen.sensor].add(s);
      }
    }
    if (!is_used(config, samples[s])) unused.add(s);
  }
  for (const auto& [sensor, found] : empty) {
    if (!with_features.contains(sensor)) continue;  // never sees anything: reported elsewhere
    diagnostics.warning(place_of(samples, found.first),
                        fmt::format("sensor '{}' has no usable feature, so its observation is left "
                                    "out{}",
                                    sensor, found.others()));
  }
  if (unused.count > 0 && unused.count < samples.size()) {
    diagnostics.warning(
        place_of(samples, unused.first),
        fmt::format("no error block uses the sample: none finds features of all its "
                    "models{}",
                    unused.others()));
  }
}

}  // namespace kinecal::detail
