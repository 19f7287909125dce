// What samples have of each sensor, for answers_from_samples.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>
#include <span>
#include <string>
#include <vector>

#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// What the samples have of one sensor.
struct SeenSensor {
  std::string name;
  std::vector<std::string> frames = {};  ///< of its features
  bool is_camera = false;
  bool in_pixels = true;  ///< every z is zero
  bool varies = false;    ///< its features differ between samples
  std::size_t alone = 0;  ///< samples in which only it observes
  std::vector<Feature> first = {};
};

inline void add_features(SeenSensor& sensor, const Observation& seen) {
  sensor.is_camera = sensor.is_camera || seen.camera.has_value();
  for (const Feature& feature : seen.features) {
    if (std::find(sensor.frames.begin(), sensor.frames.end(), feature.frame) ==
        sensor.frames.end()) {
      sensor.frames.push_back(feature.frame);
    }
    sensor.in_pixels = sensor.in_pixels && feature.point.z() == 0.0;
    // Of the same feature: a view may have only some corners of a board.
    const auto before =
        std::find_if(sensor.first.begin(), sensor.first.end(), [&](const Feature& known) {
          return known.frame == feature.frame && known.id == feature.id &&
                 (feature.id || &known - sensor.first.data() == &feature - seen.features.data());
        });
    if (before == sensor.first.end()) {
      sensor.first.push_back(feature);
    } else if ((before->point - feature.point).norm() > 1e-6) {
      sensor.varies = true;
    }
  }
}

/// All sensors, in the order of their first observations.
[[nodiscard]] inline std::vector<SeenSensor> sensors_of(std::span<const Sample> samples) {
  std::vector<SeenSensor> sensors;
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) {
      auto sensor = std::find_if(sensors.begin(), sensors.end(),
                                 [&](const SeenSensor& s) { return s.name == seen.sensor; });
      if (sensor == sensors.end()) {
        sensors.push_back({seen.sensor});
        sensor = std::prev(sensors.end());
      }
      add_features(*sensor, seen);
      if (sample.observations.size() == 1) ++sensor->alone;
    }
  }
  return sensors;
}

[[nodiscard]] inline std::string names_of(const std::vector<const SeenSensor*>& sensors) {
  std::string names;
  for (const SeenSensor* sensor : sensors) {
    names += (names.empty() ? "'" : ", '") + sensor->name + "'";
  }
  return names;
}

}  // namespace kinecal::detail
