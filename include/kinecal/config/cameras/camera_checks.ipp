// What start_cameras() cannot begin with: sensors that are in no sample, images of two sizes, intrinsics that cannot
// be, corners that were not seen.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/cameras/known_cameras.ipp"
#include "kinecal/config/cameras/target_pairs.ipp"
#include "kinecal/config/config.hpp"
#include "kinecal/config/doubts/unseen_corners.hpp"
#include "kinecal/config/missing_sensors.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/lenses/lens.hpp"

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

/// Reports samples without the size of a camera's images, where others have it; warns if none has it.
inline void check_sized(const ModelConfig& camera, const std::vector<Sample>& samples,
                        Diagnostics& diagnostics) {
  const Sample *sized = nullptr, *unsized = nullptr;
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera.name);
    if (seen == nullptr) continue;
    const bool has_size = seen->camera && seen->camera->width > 0 && seen->camera->height > 0;
    const Sample*& of = has_size ? sized : unsized;
    if (of == nullptr) of = &sample;
  }
  if (unsized == nullptr) return;
  if (sized == nullptr) {
    diagnostics.warning(
        camera.place,
        fmt::format("camera '{}': the size of its images is in no sample, so the written camera "
                    "file has image_width 0; give width and height in camera_info",
                    camera.name));
    return;
  }
  const CameraInfo& info = *sized->observation(camera.name)->camera;
  diagnostics.errors.push_back(
      fmt::format("{}: sensor '{}' has no camera_info with the size of its image here, at {} it is "
                  "{}x{} pixels; "
                  "give it to all samples, or leave this one out",
                  unsized->source, camera.name, sized->source, info.width, info.height));
}

/// Reports a camera_info with intrinsics that cannot be.
inline void check_intrinsics(const ModelConfig& camera, const std::vector<Sample>& samples,
                             Diagnostics& diagnostics) {
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera.name);
    if (seen == nullptr || !seen->camera || !is_known(&*seen->camera)) continue;
    try {  // a camera whose lens is given, or searched for, has raw images
      (void)Lens(*seen->camera, camera.lens.empty() ? camera.image : ImageKind::raw);
    } catch (const SettingsError& e) {
      diagnostics.errors.push_back(
          fmt::format("{}: sensor '{}': {}", sample.source, camera.name, e.what()));
      return;
    }
  }
}

/// Reports what is wrong with the samples of cameras, before anything is solved.
inline void check_cameras(const Config& config, const Robot& robot,
                          const std::vector<Sample>& samples, Diagnostics& diagnostics) {
  std::set<std::string> checked;
  for (const TargetPair& pair : target_pairs(config, robot)) {
    if (!checked.insert(pair.camera->name).second) continue;
    check_sized(*pair.camera, samples, diagnostics);
    check_intrinsics(*pair.camera, samples, diagnostics);
    check_unseen(pair.camera->name, samples, diagnostics);
  }
}

}  // namespace kinecal::detail
