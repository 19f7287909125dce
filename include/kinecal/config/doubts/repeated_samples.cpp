// Definitions of repeated_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/repeated_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/config/doubts/same_feature.ipp"
#include "kinecal/trust/judge_input.hpp"

namespace kinecal::detail {

/// Indices of the samples of each pose: positions and measured poses equal to 1e-5
/// rad or metres.
[[nodiscard]] inline std::vector<std::vector<std::size_t>> samples_by_pose(
    std::span<const UsedJoint> joints, std::span<const Sample> samples) {
  constexpr double kSame = 1e-5, kLargest = 1e12;
  const std::size_t count = samples.size();
  std::vector<std::vector<long long>> poses(count);
  const auto add = [&](std::size_t sample, double position) {
    const double steps = position / kSame;
    poses[sample].push_back(std::abs(steps) < kLargest ? std::llround(steps) : 0);
  };
  for (const UsedJoint& joint : joints) {
    for (std::size_t i = 0; i < joint.positions.size(); ++i) {
      add(joint.samples[i], joint.positions[i]);
    }
  }
  for (std::size_t s = 0; s < count; ++s) {
    for (const auto& [joint, pose] : samples[s].poses) {
      for (const double number : pose.translation) add(s, number);
      for (const double number : pose.rotation.reshaped()) add(s, number);
    }
  }
  std::map<std::vector<long long>, std::vector<std::size_t>> by_pose;
  for (std::size_t s = 0; s < count; ++s) by_pose[poses[s]].push_back(s);
  if (by_pose.size() > 1)
    by_pose.erase(std::vector<long long>{});  // samples that have no pose are not of one pose
  std::vector<std::vector<std::size_t>> groups;
  for (auto& [pose, of_pose] : by_pose) groups.push_back(std::move(of_pose));
  return groups;
}

/// The largest distance between the same features of two observations, metres or pixels; infinite
/// if they are not comparable.
[[nodiscard]] inline double change_between(const Observation& a, const Observation& b) {
  double most = 0.0;
  std::size_t compared = 0;
  for (std::size_t i = 0; i < a.features.size(); ++i) {
    if (!a.features[i].id && a.features.size() != b.features.size()) return HUGE_VAL;
    const Feature* other = same_feature(b, a.features[i], i);
    if (other == nullptr) continue;
    ++compared;
    if (a.features[i].frame != other->frame) return HUGE_VAL;
    const auto &p = a.features[i].point, &q = other->point;
    if (!p.allFinite() || !q.allFinite()) {
      if (p.allFinite() != q.allFinite()) return HUGE_VAL;
      continue;
    }
    most = std::max(most, (p - q).norm());
  }
  return compared > 0 || (a.features.empty() && b.features.empty()) ? most : HUGE_VAL;
}

/// All numbers recorded by the sensors in a sample, for comparison; rounded to 1e-6 of their units,
/// so that a copy printed with fewer digits still counts.
using RecordedNumbers = std::pair<std::vector<std::string>, std::vector<double>>;

[[nodiscard]] inline RecordedNumbers recorded_in(const Sample& sample) {
  RecordedNumbers all;
  const auto add = [&](double number) {  // NaN must be comparable, too
    all.second.push_back(std::isnan(number) ? HUGE_VAL : std::round(1e6 * number));
  };
  for (const Observation& seen : sample.observations) {
    all.first.push_back(seen.sensor);
    for (const Feature& feature : seen.features) {
      all.first.push_back(feature.frame);
      for (const double number : feature.point) add(number);
      for (const auto& [name, value] : feature.conditions) add(value);
      if (!feature.rotation) continue;
      for (const double number : feature.rotation->reshaped()) add(number);
    }
  }
  for (const auto& [name, value] : sample.conditions) {
    all.first.push_back(name);
    add(value);
  }
  return all;
}

/// The sensor that sees something else while another one sees the same; nullptr if absent.
/// @param pixels  names of the sensors whose features are pixels
[[nodiscard]] inline const Observation* contradiction(const Sample& a, const Sample& b,
                                                      const std::set<std::string>& pixels) {
  const Observation* changed = nullptr;
  std::size_t same = 0;
  for (const Observation& seen : a.observations) {
    const Observation* other = b.observation(seen.sensor);
    if (other == nullptr) return nullptr;
    const double change = change_between(seen, *other);
    if (change == HUGE_VAL) return nullptr;
    const double noise = pixels.contains(seen.sensor) ? 5.0 : 0.005;  // pixels or metres
    if (change == 0.0) ++same;
    if (change > noise) changed = &seen;
  }
  return same > 0 ? changed : nullptr;
}

/// Repetitions in all samples.
struct Repetitions {
  Occurrences copies, contradictions;
  std::size_t copied = 0;  ///< the original of copies.first
  std::size_t before = 0;  ///< the sample that contradictions.first contradicts
  std::string sensor;      ///< the sensor that sees something else
};

/// Adds the samples of one pose.
inline void add_repetitions(const std::vector<std::size_t>& group, std::span<const Sample> samples,
                            const std::set<std::string>& pixels, Repetitions& all) {
  if (group.size() < 2) return;
  std::map<RecordedNumbers, std::size_t> known;
  for (const std::size_t s : group) {
    const auto [first, is_new] = known.emplace(recorded_in(samples[s]), s);
    if (!is_new) {
      if (all.copies.add(s)) all.copied = first->second;
    } else if (const Observation* seen =
                   contradiction(samples[s], samples[group.front()], pixels)) {
      if (all.contradictions.add(s)) all.sensor = seen->sensor, all.before = group.front();
    }
  }
}

/// Error, doubt or warning: samples that are copies of others.
inline void report_copies(const Repetitions& found, std::span<const Sample> samples,
                          Diagnostics& diagnostics) {
  const Occurrences& copies = found.copies;
  if (copies.count == 0) return;
  const SourceLocation place = place_of(samples, copies.first);
  const std::string text = fmt::format("the sample is a copy of that at {}{}",
                                       place_of(samples, found.copied).str(), copies.others());
  if (copies.count + 1 == samples.size()) {
    diagnostics.error(place, fmt::format("all {} samples are the same one: joint positions and "
                                         "features are equal; record different poses",
                                         samples.size()));
  } else if (50 * copies.count > samples.size()) {
    diagnostics.doubt(place, fmt::format("{}; {}", text, kCopiesCountTwice));
  } else {
    diagnostics.warning(place, text);
  }
}

std::size_t check_repeated_samples(const Config& config, std::span<const UsedJoint> joints,
                                   std::span<const Sample> samples, Diagnostics& diagnostics) {
  const std::set<std::string> pixels = pixel_models(config);
  Repetitions found;
  for (const auto& group : samples_by_pose(joints, samples)) {
    add_repetitions(group, samples, pixels, found);
  }
  report_copies(found, samples, diagnostics);
  if (const Occurrences& contradictions = found.contradictions; contradictions.count > 0) {
    diagnostics.doubt(
        place_of(samples, contradictions.first),
        fmt::format("the joint positions are those of {}, but sensor '{}' sees "
                    "something else{}; was the robot moving, or did the target slip?",
                    place_of(samples, found.before).str(), found.sensor, contradictions.others()));
  }
  return samples.size() - found.copies.count;
}

}  // namespace kinecal::detail
