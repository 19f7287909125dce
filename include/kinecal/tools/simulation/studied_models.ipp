// The models and target features that a study simulates, for pose_samples.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/tools/simulation/place_target.ipp"

namespace kinecal::detail {

/// The features of a target in its own frame: LEDs in their link.
[[nodiscard]] inline std::vector<Vector3<double>> features_of(const SimulatedTarget& target) {
  std::vector<Vector3<double>> points;
  if (!is_board(target)) return points_of(target);
  const bool tags = has_tags(target);
  const TagGridShape shape = tags_of(target);
  const double step = tags ? target.size * (1.0 + double(shape.gap) / shape.tag()) : target.size;
  for (int row = 0; row < target.rows; ++row) {
    for (int column = 0; column < target.columns; ++column) {
      const Vector3<double> corner(column * step, row * step, 0.0);
      if (!tags) points.push_back(corner);
      if (!tags) continue;
      for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        points.push_back(corner + target.size * Vector3<double>(x, y, 0.0));
      }
    }
  }
  return points;
}

/// The models that a study simulates.
struct StudiedModels {
  const ModelConfig* camera = nullptr;
  const ModelConfig* chain = nullptr;
  std::string frame = {};  ///< the virtual frame of the target; empty: its points are in the link
};

[[nodiscard]] inline StudiedModels studied_models(const SimulationPlan& plan,
                                                  const Config& config) {
  const StepConfig& step = config.steps.back();
  const auto model = [&](const std::string& name) -> const ModelConfig* {
    for (const ModelConfig& of : step.models) {
      if (of.name == name) return &of;
    }
    return nullptr;
  };
  for (const BlockConfig& block : step.error_blocks) {
    if (block.models.size() != 2) continue;
    StudiedModels models{model(block.models[0]), model(block.models[1])};
    if (models.camera == nullptr || models.chain == nullptr) continue;
    if (!models.camera->type.starts_with("camera")) std::swap(models.camera, models.chain);
    if (!same_frame(models.camera->frame, plan.setup.camera.frame)) continue;
    if (models.chain->type.starts_with("camera")) continue;
    for (const FreeFrameConfig& frame : step.free_frames) {
      if (is_board(plan.target) && !plan.setup.robot.has_joint(frame.name))
        models.frame = frame.name;
    }
    return models;
  }
  throw InputError(config.place.file + ": no error block compares a camera in '" +
                   plan.setup.camera.frame +
                   "' with a chain; give recorded samples, whose features are then simulated");
}

}  // namespace kinecal::detail
