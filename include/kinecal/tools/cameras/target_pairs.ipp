// Cameras that see targets with a pose of their own in each sample, and their views: for start_cameras.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/samples/paired_features.hpp"
#include "kinecal/tools/cameras/camera_start.hpp"

namespace kinecal::detail {

/// A camera that sees a target with a pose of its own, by the error block that compares them.
struct TargetPair {
  const ModelConfig* target = nullptr;
  const ModelConfig* camera = nullptr;
  std::string joint;  ///< the floating joint of the target
};

/// The pairs of a configuration.
[[nodiscard]] inline std::vector<TargetPair> target_pairs(const Config& config,
                                                          const Robot& robot) {
  std::vector<TargetPair> pairs;
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      const BlockEntry* entry = registry().block(block.type);
      if (entry == nullptr || entry->read_as != PointToPixel::kType) continue;
      TargetPair pair;
      for (const ModelConfig& model : step.models) {
        if (model.name == block.models[0]) pair.target = &model;
        if (model.name == block.models[1]) pair.camera = &model;
      }
      if (pair.target == nullptr || pair.camera == nullptr) continue;
      const Joint* above =
          robot.has_link(pair.target->frame) ? robot.parent_joint(pair.target->frame) : nullptr;
      for (const FreeParamConfig& frame : config.per_sample) {
        if (above != nullptr && above->name == frame.name) pair.joint = frame.name;
      }
      const bool known = std::any_of(pairs.begin(), pairs.end(), [&](const TargetPair& other) {
        return other.target->name == pair.target->name && other.camera->name == pair.camera->name;
      });
      if (!pair.joint.empty() && !known) pairs.push_back(pair);
    }
  }
  return pairs;
}

/// The view of a pair in a sample; no corners if there is none, or the target is not flat.
[[nodiscard]] inline TargetView target_view(const TargetPair& pair, const Sample& given) {
  const ComparedSensors both{{pair.target->name, pair.camera->name}};
  const std::optional<Sample> paired =
      has_ids(given) ? pair_features(given, std::span(&both, 1)) : std::nullopt;
  const Sample& sample = paired ? *paired : given;
  const Observation *target = sample.observation(pair.target->name),
                    *camera = sample.observation(pair.camera->name);
  TargetView view;
  if (target == nullptr || camera == nullptr) return view;
  const std::size_t count = std::min(target->features.size(), camera->features.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3<double>&on = target->features[i].point, &seen = camera->features[i].point;
    if (!on.allFinite() || !seen.allFinite()) continue;
    constexpr double kFlat = 1e-6;  // metres
    if (std::abs(on.z() - target->features[0].point.z()) > kFlat) return {};
    view.plane.emplace_back(on.head<2>());
    view.pixels.emplace_back(seen.head<2>());
  }
  return view;
}

}  // namespace kinecal::detail
