// A few samples, with a few features each, to search for frames.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"

namespace kinecal::detail {

/// `count` numbers from 0 to size - 1, evenly spread; all if there are fewer.
[[nodiscard]] inline std::vector<std::size_t> spread(std::size_t size, std::size_t count) {
  std::vector<std::size_t> chosen;
  if (size <= count) count = size;
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(count == 1 ? 0 : i * (size - 1) / (count - 1));
  }
  return chosen;
}

/// Distance between two features, summed over a sample's observations that have both; -1 if one of
/// them is not observed twice, so that nothing compares it.
[[nodiscard]] inline double distance_of_features(const Sample& sample, std::size_t i,
                                                 std::size_t j) {
  double sum = 0.0;
  std::size_t of_i = 0, of_j = 0;  // observations
  for (const Observation& seen : sample.observations) {
    const Vector3<double>&a = seen.features[i].point, &b = seen.features[j].point;
    of_i += a.allFinite() ? 1 : 0;
    of_j += b.allFinite() ? 1 : 0;
    if (a.allFinite() && b.allFinite()) sum += (a - b).norm();
  }
  const std::size_t enough = std::min<std::size_t>(2, sample.observations.size());
  return std::min(of_i, of_j) >= enough ? sum : -1.0;
}

/// A few features of a sample, each as far as possible from the previous ones: the corners of a
/// board.
[[nodiscard]] inline std::vector<std::size_t> far_apart(const Sample& sample, std::size_t size) {
  constexpr std::size_t kFeatures = 4;
  std::size_t first = 0;
  while (first + 1 < size && distance_of_features(sample, first, first) < 0.0) ++first;
  std::vector<std::size_t> chosen = {first};
  std::vector<double> nearest(size, std::numeric_limits<double>::infinity());
  while (chosen.size() < kFeatures) {
    for (std::size_t i = 0; i < size; ++i) {
      nearest[i] = std::min(nearest[i], distance_of_features(sample, i, chosen.back()));
    }
    const auto furthest = std::max_element(nearest.begin(), nearest.end());
    if (!(*furthest > 0.0)) break;
    chosen.push_back(static_cast<std::size_t>(furthest - nearest.begin()));
  }
  return chosen;
}

/// A sample with a few of its features.  Observations of a sample show the same features, so all of
/// them keep the same ones.
[[nodiscard]] inline Sample with_few_features(Sample sample) {
  constexpr std::size_t kMany = 6;
  if (sample.observations.empty()) return sample;
  const std::size_t size = sample.observations.front().features.size();
  for (const Observation& seen : sample.observations) {
    if (seen.features.size() != size) return sample;
  }
  if (size <= kMany) return sample;
  const std::vector<std::size_t> chosen = far_apart(sample, size);
  for (Observation& seen : sample.observations) {
    std::vector<Feature> few;
    for (const std::size_t i : chosen) few.push_back(seen.features[i]);
    seen.features = std::move(few);
  }
  return sample;
}

/// Rectifies pixels: without distortion, a line of sight takes a tenth of the time.
inline void rectify(Observation& seen, const AnySensor& camera) {
  if (!seen.camera) return;
  std::vector<double> s;
  try {
    s = camera.settings(seen);
  } catch (const SettingsError&) {  // adding the sample reports the reason
    return;
  }
  if (std::all_of(s.begin() + 4, s.end(), [](double d) { return d == 0.0; })) return;
  for (Feature& feature : seen.features) {
    const Vector3<double> ray = camera.place(feature.point, s);
    feature.point = {s[0] * ray.x() + s[2], s[1] * ray.y() + s[3], feature.point.z()};
  }
  seen.camera->d.clear();
  seen.camera->p = {s[0], 0, s[2], 0, 0, s[1], s[3], 0, 0, 0, 1, 0};
}

/// A sample as an excerpt has it: with few features, and those of a camera rectified.
/// @param problem  that takes it
[[nodiscard]] inline Sample excerpt_of(const AnyProblem& problem, const Sample& sample) {
  Sample few = with_few_features(problem.paired(sample).value_or(sample));
  for (Observation& seen : few.observations) {
    for (const MountedSensor& sensor : problem.sensors()) {
      const bool is_it = sensor.mount().name == seen.sensor;
      if (is_it && sensor.sensor().delivers(Quantity::pixel)) rectify(seen, sensor.sensor());
    }
  }
  return few;
}

/// Samples of an excerpt.
struct FewSamples {
  std::vector<Sample> samples;
  std::vector<int> numbers;  ///< of each, among all samples
};

/// A few samples of each kind: those with observations of the same sensors.
/// @param problem  that takes all of them
[[nodiscard]] inline FewSamples few_samples(const AnyProblem& problem,
                                            std::span<const Sample> samples) {
  constexpr std::size_t kOfEachKind = 12;
  std::map<std::set<std::string>, std::vector<std::size_t>> kinds;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::set<std::string> sensors;
    for (const Observation& seen : samples[i].observations) sensors.insert(seen.sensor);
    kinds[sensors].push_back(i);
  }
  FewSamples few;
  for (const auto& [sensors, indices] : kinds) {
    for (const std::size_t i : spread(indices.size(), kOfEachKind)) {
      few.numbers.push_back(static_cast<int>(indices[i]));
      few.samples.push_back(excerpt_of(problem, samples[indices[i]]));
    }
  }
  return few;
}

}  // namespace kinecal::detail
