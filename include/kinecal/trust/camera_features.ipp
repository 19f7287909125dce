// What a camera observed in the samples of a solution: pixels, and how far away they are.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/trust/feature_places.hpp"
#include "kinecal/trust/projection_map.hpp"

namespace kinecal::detail {

/// What a camera observed.
struct SeenByCamera {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<double> distances;  ///< from the camera, metres; 0: unknown
  std::vector<double> settings;
  std::array<double, 2> low{}, high{};
};

/// Distances of a sample's features from a camera, by what another sensor of an error block says of them.
inline void set_distances(const AnyProblem& problem, const FeaturePlaces& places, int camera,
                          const Sample& sample, std::vector<double>& distances) {
  for (int t = 0; t < problem.num_terms(); ++t) {
    const std::vector<int>& sensors = problem.term(t).sensors;
    if (sensors.size() != 2 || std::find(sensors.begin(), sensors.end(), camera) == sensors.end()) {
      continue;
    }
    const int other = sensors[0] == camera ? sensors[1] : sensors[0];
    const MountedSensor& of = problem.sensors()[static_cast<std::size_t>(other)];
    const Observation* seen = sample.observation(of.mount().name);
    const auto kind = of.sensor().places();
    if (seen == nullptr || !kind || *kind == Quantity::ray || *kind == Quantity::reading) continue;
    const std::string& name = problem.sensors()[static_cast<std::size_t>(camera)].mount().name;
    const auto rays = places.placed(camera, *sample.observation(name), sample);
    const auto points = places.placed(other, *seen, sample);
    for (std::size_t i = 0; i < std::min({rays.size(), points.size(), distances.size()}); ++i) {
      if (points[i].seen) distances[i] = (points[i].point - rays[i].origin).norm();
    }
  }
}

[[nodiscard]] inline SeenByCamera seen_by(const KnownSolution& solution,
                                          const FeaturePlaces& places, int camera) {
  const AnyProblem& problem = solution.evaluator.problem();
  const MountedSensor& mounted = problem.sensors()[static_cast<std::size_t>(camera)];
  SeenByCamera all;
  all.low.fill(std::numeric_limits<double>::infinity());
  all.high.fill(-std::numeric_limits<double>::infinity());
  const CameraInfo* info = nullptr;
  for (const Sample& recorded : solution.samples) {
    const std::optional<Sample> paired = problem.paired(recorded);
    const Sample& sample = paired ? *paired : recorded;
    const Observation* seen = sample.observation(mounted.mount().name);
    if (seen == nullptr) continue;
    if (all.settings.empty()) all.settings = mounted.sensor().settings(*seen);
    if (info == nullptr && seen->camera)
      info = &*recorded.observation(mounted.mount().name)->camera;
    std::vector<double> distances(seen->features.size(), 0.0);
    set_distances(problem, places, camera, sample, distances);
    for (std::size_t i = 0; i < seen->features.size(); ++i) {
      if (!is_seen(seen->features[i])) continue;
      const Eigen::Vector2d pixel = seen->features[i].point.head<2>();
      all.pixels.push_back(pixel);
      all.distances.push_back(distances[i]);
      for (std::size_t k = 0; k < 2; ++k) {
        all.low[k] = std::min(all.low[k], pixel(static_cast<Eigen::Index>(k)));
        all.high[k] = std::max(all.high[k], pixel(static_cast<Eigen::Index>(k)));
      }
    }
  }
  if (info != nullptr && info->width > 0 && info->height > 0) {
    all.low = {0.0, 0.0};
    all.high = {static_cast<double>(info->width), static_cast<double>(info->height)};
  }
  return all;
}

}  // namespace kinecal::detail
