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

/// True if a sensor observes something in a sample.
[[nodiscard]] bool sees(const Sample& sample, const std::string& sensor) {
  const Observation* seen = sample.observation(sensor);
  return seen != nullptr && !seen->features.empty();
}

/// @param model      of the plane or line
/// @param is_frame   no sample says where it is
void place(Sample& sample, const std::string& points_of, const ModelConfig& model, bool is_frame) {
  constexpr std::size_t kCloud = 3;  // fewer may be a tip that touches nothing in this sample
  if (!sees(sample, points_of)) return;
  const Observation& points = *sample.observation(points_of);
  const std::size_t count = points.features.size();
  if (!sees(sample, model.name)) {
    if (!is_frame || count < kCloud || points.features.front().id) return;
    Feature feature{model.frame, Vector3<double>::Zero()};
    feature.rotation = Matrix3<double>::Identity();
    std::erase_if(sample.observations,
                  [&](const Observation& o) { return o.sensor == model.name; });
    sample.observations.push_back({model.name, {std::move(feature)}, {}});
  }
  for (Observation& seen : sample.observations) {
    if (seen.sensor != model.name || seen.features.size() != 1 || seen.features.front().id)
      continue;
    const Feature one = seen.features.front();
    seen.features.resize(count, one);
  }
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
      const bool is_frame = std::none_of(samples.begin(), samples.end(), [&](const Sample& sample) {
        return detail::sees(sample, model->name);
      });
      for (Sample& sample : samples) detail::place(sample, block.models[0], *model, is_frame);
    }
  }
}

}  // namespace kinecal
