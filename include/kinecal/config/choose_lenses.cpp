// Definitions of choose_lenses.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/choose_lenses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>

#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The lenses that the camera_info of a camera has, each with the first sample that has it.
struct RecordedLenses {
  std::vector<std::pair<std::string, const Sample*>> lenses;
  bool is_known = true;  ///< false if some lens is not known: choose_images() reports it
};

/// The lens that a camera_info describes: one of those that a type has, or lens_of().
[[nodiscard]] std::string recorded_lens(const CameraInfo& info, const SensorEntry& entry) {
  const auto own = std::find(entry.lenses.begin(), entry.lenses.end(), info.distortion_model);
  const bool is_own = own != entry.lenses.end() && lens_named(*own).empty();
  return is_own ? *own : lens_of(info);
}

[[nodiscard]] RecordedLenses recorded_lenses(const std::vector<Sample>& samples,
                                             const std::string& camera, const SensorEntry& entry) {
  RecordedLenses recorded;
  std::set<std::string> names;
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera);
    if (seen == nullptr || !seen->camera) continue;
    try {
      const std::string lens = recorded_lens(*seen->camera, entry);
      if (names.insert(lens).second) recorded.lenses.emplace_back(lens, &sample);
    } catch (const SettingsError&) {
      recorded.is_known = false;
    }
  }
  return recorded;
}

/// True if all of a camera's lenses are contained in a lens.
[[nodiscard]] bool contains_all(const std::string& lens, const RecordedLenses& recorded) {
  return std::all_of(recorded.lenses.begin(), recorded.lenses.end(),
                     [&](const auto& of) { return contains_lens(lens, of.first); });
}

/// Replaces the lens of the samples by one without distortion.
void replace_lens(std::vector<Sample>& samples, const std::string& camera, const SensorEntry& entry,
                  const std::string& lens) {
  const auto sensor = entry.make({ImageKind::raw, lens});
  const std::size_t coefficients = sensor->parameters().size() - kIntrinsics;
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != camera || !seen.camera) continue;
      seen.camera->distortion_model = distortion_model_of(lens);
      seen.camera->d.assign(coefficients, 0.0);
    }
  }
}

void set_lens(Config& config, const std::string& camera, const std::string& lens) {
  for (StepConfig& step : config.steps) {
    for (ModelConfig& model : step.models) {
      const SensorEntry* entry = entry_of(model);
      if (model.name == camera && entry != nullptr && !entry->lenses.empty()) model.lens = lens;
    }
  }
}

/// The lens of a camera whose lens the configuration does not give.
void take_recorded_lens(Config& config, const ModelConfig& camera, const RecordedLenses& recorded,
                        Diagnostics& diagnostics) {
  if (recorded.lenses.empty() || !recorded.is_known) return;
  const auto largest =
      std::find_if(recorded.lenses.begin(), recorded.lenses.end(),
                   [&](const auto& of) { return contains_all(of.first, recorded); });
  if (largest == recorded.lenses.end()) {
    const auto &a = recorded.lenses[0], &b = recorded.lenses[1];
    diagnostics.error(
        camera.place,
        fmt::format("sensor '{}' has two lenses: {} at {}, {} at {}; give each camera a name of "
                    "its own",
                    camera.name, a.first, a.second->source, b.first, b.second->source));
    return;
  }
  set_lens(config, camera.name, largest->first);
}

}  // namespace
}  // namespace detail

void choose_lenses(Config& config, std::vector<Sample>& samples, Diagnostics& diagnostics) {
  for (const ModelConfig& camera : detail::models_of(config)) {
    const SensorEntry* entry = entry_of(camera);
    if (entry == nullptr || entry->lenses.empty() || camera.image == ImageKind::rectified) continue;
    const detail::RecordedLenses recorded = detail::recorded_lenses(samples, camera.name, *entry);
    if (camera.lens.empty()) {
      detail::take_recorded_lens(config, camera, recorded, diagnostics);
      continue;
    }
    detail::set_lens(config, camera.name, camera.lens);
    if (camera.lens == kAnyLens || detail::contains_all(camera.lens, recorded)) continue;
    const std::string& before = recorded.lenses.front().first;
    const std::string what = fmt::format("sensor '{}': its lens is {}, camera_info says {}",
                                         camera.name, camera.lens, before);
    if (detail::free_coefficient(config, camera).empty()) {
      diagnostics.error(camera.place,
                        what + "; free the coefficients of this lens, which are not known");
      continue;
    }
    diagnostics.note(camera.place,
                     what + ", which is not used: the search begins without distortion");
    detail::replace_lens(samples, camera.name, *entry, camera.lens);
  }
}

}  // namespace kinecal
