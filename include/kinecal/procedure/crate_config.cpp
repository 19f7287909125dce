// Definitions of crate_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/crate_config.hpp"

#include <algorithm>

#include "kinecal/errors/point_to_mesh.hpp"
#include "kinecal/errors/point_to_outline.hpp"

namespace kinecal::detail {

std::map<std::string, double> default_numbers(const std::string& type, double scale) {
  std::map<std::string, double> numbers;
  const BlockEntry* entry = registry().block(type);
  if (entry == nullptr) return numbers;
  numbers.insert(entry->numbers.begin(), entry->numbers.end());
  if (numbers.contains("scale")) numbers["scale"] = scale;
  return numbers;
}

void add_surfaces(StepConfig& step) {
  for (BlockConfig& block : step.error_blocks) {
    const bool is_outline = block.type == PointToOutline::kType;
    if (!is_outline && block.type != PointToMesh::kType) continue;
    const std::string& name = block.models.at(is_outline ? 0 : 1);
    const auto of_robot = std::ranges::find(step.models, name, &ModelConfig::name);
    of_robot->is_surface = true;
    block.surface = SurfaceConfig{.links = of_robot->frames()};
  }
}

void keep_associations(std::span<const Sample> samples, Config& config) {
  for (BlockConfig& block : config.steps.back().error_blocks) {
    if (!block.surface) continue;
    const std::string& name = block.models.at(block.type == PointToOutline::kType ? 0 : 1);
    const bool are_given = std::ranges::any_of(
        samples, [&](const Sample& sample) { return sample.observation(name) != nullptr; });
    if (are_given) block.surface.reset();
  }
}

void add_free(const std::string& name, const std::string& frame, StepConfig& step) {
  if (frame.empty()) {
    step.free_params.push_back({name, step.place});
    return;
  }
  auto free = std::find_if(step.free_frames.begin(), step.free_frames.end(),
                           [&](const FreeFrameConfig& one) { return one.name == frame; });
  if (free == step.free_frames.end()) {
    free = step.free_frames.insert(step.free_frames.end(), {frame, {}, step.place});
  }
  for (std::size_t axis = 0; axis < kFrameAxes.size(); ++axis) {
    if (name == parameter_name(frame, kFrameAxes[axis])) free->axes[axis] = true;
  }
}

void add_initial_values(const ParameterTable& table, StepConfig& step) {
  constexpr double kUnbounded = 1e300;
  for (const Parameter& parameter : table) {
    if (parameter.value != 0.0) {
      step.initial_values.push_back({parameter.name, parameter.value, step.place});
    }
    if (parameter.lower > -kUnbounded || parameter.upper < kUnbounded) {
      step.bounds.push_back({parameter.name, parameter.lower, parameter.upper, step.place});
    }
  }
}

}  // namespace kinecal::detail
