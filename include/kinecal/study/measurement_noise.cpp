// Definitions of measurement_noise.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/measurement_noise.hpp"

#include <algorithm>
#include <cmath>

namespace kinecal {

namespace detail {
namespace {

/// Errors of a point of a depth camera: along the columns, the rows and the ray.
[[nodiscard]] std::vector<FeatureChange> errors_of_depth(const AnySensor& sensor,
                                                         const Observation& seen,
                                                         const Vector3<double>& p,
                                                         const MeasurementNoise& noise) {
  const std::vector<double> settings = sensor.settings(seen);
  const double z = p.z();
  return {{{noise.pixel * z / settings[0], 0.0, 0.0}},
          {{0.0, noise.pixel * z / settings[1], 0.0}},
          {p * (noise.depth * z)}};
}

/// True if a sensor observed different features in some samples.
[[nodiscard]] bool features_differ(const std::string& sensor, std::span<const Sample> samples) {
  const Observation* first = nullptr;
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(sensor);
    if (seen == nullptr) continue;
    if (first == nullptr) first = seen;
    const std::size_t both = std::min(first->features.size(), seen->features.size());
    for (std::size_t i = 0; i < both; ++i) {
      const Feature &a = first->features[i], &b = seen->features[i];
      if (a.id != b.id || !a.point.allFinite() || !b.point.allFinite()) continue;
      if (a.point != b.point || a.rotation != b.rotation) return true;
    }
  }
  return false;
}

}  // namespace
}  // namespace detail

Feature changed(const Feature& feature, const FeatureChange& change, double factor) {
  Feature result = feature;
  result.point += factor * change.point;
  if (result.rotation) {
    *result.rotation = *result.rotation * exp(Vector3<double>(factor * change.rotation));
  }
  return result;
}

std::vector<FeatureChange> errors_of(const MountedSensor& sensor, const Observation& seen,
                                     const Feature& feature, const MeasurementNoise& noise) {
  std::vector<FeatureChange> errors;
  const bool is_pixel = detail::measures_pixels(sensor, seen);
  if (!feature.sigma && seen.camera && !is_pixel) {
    errors = detail::errors_of_depth(sensor.sensor(), seen, feature.point, noise);
  } else {
    const double size = feature.sigma.value_or(is_pixel ? noise.pixel : noise.point);
    for (Eigen::Index axis = 0; axis < (is_pixel ? 2 : 3); ++axis) {
      errors.push_back({size * Vector3<double>::Unit(axis)});
    }
  }
  if (!sensor.sensor().is_oriented()) return errors;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    errors.push_back({Vector3<double>::Zero(), noise.rotation * Vector3<double>::Unit(axis)});
  }
  return errors;
}

std::set<std::string> measuring_sensors(const AnyProblem& problem,
                                        std::span<const Sample> samples) {
  std::set<std::string> measuring;
  for (int t = 0; t < problem.num_terms(); ++t) {
    bool has_one = false;
    for (const int s : problem.term(t).sensors) {
      const MountedSensor& sensor = problem.sensors()[static_cast<std::size_t>(s)];
      const std::string& name = sensor.mount().name;
      if (!sensor.sensor().in_own_frame() && !detail::features_differ(name, samples)) continue;
      measuring.insert(name);
      has_one = true;
    }
    if (has_one || problem.term(t).sensors.empty()) continue;
    const auto last = static_cast<std::size_t>(problem.term(t).sensors.back());
    measuring.insert(problem.sensors()[last].mount().name);
  }
  return measuring;
}

Sample with_noise(const Sample& exact, const AnyProblem& problem,
                  const std::set<std::string>& measuring, const MeasurementNoise& noise,
                  SeededRandom& random) {
  Sample sample = exact;
  for (double& position : sample.joint_positions) position += noise.joint * random.normal();
  for (const MountedSensor& sensor : problem.sensors()) {
    if (!measuring.contains(sensor.mount().name)) continue;
    for (Observation& seen : sample.observations) {
      if (seen.sensor != sensor.mount().name) continue;
      for (Feature& feature : seen.features) {
        for (const FeatureChange& error : errors_of(sensor, seen, feature, noise)) {
          feature = changed(feature, error, random.normal());
        }
      }
    }
  }
  return sample;
}

}  // namespace kinecal
