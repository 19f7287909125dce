// Definitions of place_planes.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/place_planes.hpp"

#include <algorithm>
#include <string>

#include "kinecal/errors/point_on_line.hpp"
#include "kinecal/errors/point_on_plane.hpp"

namespace kinecal {

namespace detail {
namespace {

/// @param model  of the plane or line
void place(Sample& sample, const std::string& points_of, const ModelConfig& model) {
  const Observation* points = sample.observation(points_of);
  if (points == nullptr || points->features.empty()) return;
  const std::size_t count = points->features.size();  // adding an observation moves them
  const auto is_it = [&](const Observation& seen) { return seen.sensor == model.name; };
  auto plane = std::find_if(sample.observations.begin(), sample.observations.end(), is_it);
  if (plane == sample.observations.end()) {
    plane = sample.observations.insert(plane, Observation{model.name, {}, {}});
  }
  if (plane->features.empty()) {
    Feature feature{model.frame, Vector3<double>::Zero()};
    feature.rotation = Matrix3<double>::Identity();
    plane->features.push_back(std::move(feature));
  }
  if (plane->features.size() != 1 || plane->features.front().id) return;
  const Feature one = plane->features.front();
  plane->features.resize(count, one);
}

}  // namespace
}  // namespace detail

void place_planes(const Config& config, std::vector<Sample>& samples) {
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      if (block.type != PointOnPlane::kType && block.type != PointOnLine::kType) continue;
      const auto model =
          std::find_if(step.models.begin(), step.models.end(), [&](const ModelConfig& one) {
            return block.models.size() == 2 && one.name == block.models[1];
          });
      if (model == step.models.end()) continue;
      for (Sample& sample : samples) detail::place(sample, block.models[0], *model);
    }
  }
}

}  // namespace kinecal
