// Cameras that see targets with a pose of their own in each sample, and their views: for start_cameras.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/config/cameras/target_view.ipp"
#include "kinecal/config/parameters_from_config.hpp"

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
      const BlockEntry* entry = entry_of(block);
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

/// The view of a pair in a sample: see target_view.ipp.
[[nodiscard]] inline TargetView target_view(const TargetPair& pair, const Sample& sample) {
  return target_view(pair.target->name, pair.camera->name, sample);
}

}  // namespace kinecal::detail
