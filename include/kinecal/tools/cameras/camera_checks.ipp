// What start_cameras() cannot begin with: sensors that are in no sample, images of two sizes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/missing_sensors.ipp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/tools/cameras/target_pairs.ipp"

namespace kinecal::detail {

/// Reports images of two sizes.
/// @param first  a sample of another file that has an image of the camera; nullptr: the first of these
/// @returns  false if there are
[[nodiscard]] inline bool check_sizes(const ModelConfig& camera, const std::vector<Sample>& samples,
                                      Diagnostics& diagnostics, const Sample* first = nullptr) {
  const auto size = [&](const Sample& sample) {
    const CameraInfo& info = *sample.observation(camera.name)->camera;
    return std::pair(info.width, info.height);
  };
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera.name);
    if (seen == nullptr || !seen->camera) continue;
    if (first == nullptr) first = &sample;
    if (size(sample) == size(*first)) continue;
    diagnostics.error(
        camera.place,
        fmt::format("camera '{}': images of two sizes: {}x{} at {}, {}x{} at {}", camera.name,
                    size(*first).first, size(*first).second, first->source, size(sample).first,
                    size(sample).second, sample.source));
    return false;
  }
  return true;
}

/// Reports targets and cameras that are in no sample.
/// @returns  false if there are
[[nodiscard]] inline bool check_sensors(const Config& config, const std::vector<TargetPair>& pairs,
                                        const std::vector<Sample>& samples,
                                        Diagnostics& diagnostics) {
  const auto is_needed = [&](const ModelConfig* model) {
    return std::any_of(pairs.begin(), pairs.end(), [&](const TargetPair& pair) {
      return pair.target->name == model->name || pair.camera->name == model->name;
    });
  };
  for (const StepConfig& step : config.steps) {
    MissingSensors missing = missing_sensors(step, samples);
    std::erase_if(missing.models, [&](const ModelConfig* model) { return !is_needed(model); });
    if (missing.models.empty()) continue;
    diagnostics.error(missing.models.front()->place, sentence_of(missing));
    return false;
  }
  return true;
}

}  // namespace kinecal::detail
