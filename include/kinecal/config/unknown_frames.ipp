// Free frames without a configured pose, and a few samples for the search.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "kinecal/config/config.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/solve/fit_frames.hpp"

namespace kinecal::detail {

/// Names of frames that a previous step has found.
[[nodiscard]] inline std::set<std::string> found_frames(const Config& config,
                                                        const StepConfig& until) {
  std::set<std::string> found;
  for (const StepConfig& step : config.steps) {
    if (&step == &until) break;
    for (const FreeFrameConfig& frame : step.free_frames) found.insert(frame.name);
  }
  return found;
}

/// True if the configuration gives a frame's pose, in this step or before it.
[[nodiscard]] inline bool is_given(const Config& config, const StepConfig& until,
                                   const std::string& frame) {
  for (const StepConfig& step : config.steps) {
    for (const FrameInitialValueConfig& value : step.frame_initial_values) {
      if (value.name == frame && !(value.xyz.isZero() && value.rpy.isZero())) return true;
    }
    for (const InitialValueConfig& value : step.initial_values) {
      for (const auto axis : kFrameAxes) {
        if (value.name == parameter_name(frame, axis) && value.value != 0.0) return true;
      }
    }
    if (&step == &until) break;
  }
  return false;
}

/// True for a joint whose pose may be a placeholder: it is fixed, free in all axes, and not held by
/// a prior.
[[nodiscard]] inline bool may_be_anywhere(const Joint& joint, const FreeFrameConfig& frame,
                                          const StepConfig& step) {
  return joint.type == JointType::fixed &&
         std::all_of(frame.axes.begin(), frame.axes.end(), [](bool free) { return free; }) &&
         std::none_of(step.error_blocks.begin(), step.error_blocks.end(),
                      [&](const BlockConfig& block) { return block.param == frame.name; });
}

/// The free frames of a step whose pose may need a search: virtual frames, and fixed joints with
/// placeholders in the URDF.  A zero pose never counts as a guess.
[[nodiscard]] inline std::vector<UnknownFrame> unknown_frames(const Config& config,
                                                              const StepConfig& step,
                                                              const Robot& robot,
                                                              const ParameterTable& table,
                                                              const FreeSet& free) {
  const std::set<std::string> found_before = found_frames(config, step);
  std::vector<UnknownFrame> unknown;
  for (const FreeFrameConfig& frame : step.free_frames) {
    if (found_before.contains(frame.name)) continue;
    UnknownFrame found{frame.name};
    found.has_guess = is_given(config, step, frame.name);
    if (robot.has_joint(frame.name)) {
      const Joint& joint = robot.joint(frame.name);
      if (!may_be_anywhere(joint, frame, step)) continue;
      found.has_guess = found.has_guess || !joint.origin.rotation.isIdentity() ||
                        !joint.origin.translation.isZero();
    }
    bool any = false;
    for (std::size_t k = 0; k < 6; ++k) {
      const int parameter = table.find(parameter_name(frame.name, kFrameAxes[k]));
      if (free.column(parameter) < 0) continue;
      found.axes[k] = parameter;
      any = true;
    }
    if (any) unknown.push_back(std::move(found));
  }
  const bool turns = std::any_of(unknown.begin(), unknown.end(),
                                 [](const UnknownFrame& frame) { return frame.turns(); });
  return turns ? unknown : std::vector<UnknownFrame>();
}

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

/// Samples of an excerpt.
struct FewSamples {
  std::vector<Sample> samples;
  std::vector<int> numbers;  ///< of each, among all samples
};

/// A few samples of each kind: those with observations of the same sensors.
/// @param problem  that takes all of them
[[nodiscard]] inline FewSamples few_samples(
    const AnyProblem& problem, std::span<const Sample> samples) {
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
      const Sample& sample = samples[indices[i]];
      few.numbers.push_back(static_cast<int>(indices[i]));
      few.samples.push_back(with_few_features(problem.paired(sample).value_or(sample)));
      for (Observation& seen : few.samples.back().observations) {
        for (const MountedSensor& sensor : problem.sensors()) {
          const bool is_it = sensor.mount().name == seen.sensor;
          if (is_it && sensor.sensor().delivers(Quantity::pixel)) rectify(seen, sensor.sensor());
        }
      }
    }
  }
  return few;
}

}  // namespace kinecal::detail
