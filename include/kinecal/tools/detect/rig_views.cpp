// Joins what several cameras saw at once.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/rig_views.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "kinecal/files/natural_order.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Adds features of a target that another camera did not see.
void join_target(Observation& into, const Observation& from, const std::string& source) {
  const auto has_id = [](const Feature& feature) { return feature.id.has_value(); };
  const bool ids = std::all_of(into.features.begin(), into.features.end(), has_id) &&
                   std::all_of(from.features.begin(), from.features.end(), has_id);
  if (!ids) {
    if (into.features.size() == from.features.size()) return;
    throw SampleError(source + ": cameras see other features of '" + into.sensor +
                      "', and these have no ids");
  }
  for (const Feature& feature : from.features) {
    const bool known = std::any_of(into.features.begin(), into.features.end(),
                                   [&](const Feature& other) { return other.id == feature.id; });
    if (!known) into.features.push_back(feature);
  }
}

/// What a sample is of: its photograph, and the target that a finder saw in it, by sensor and frame.
using ViewKey = std::pair<std::string, std::string>;

[[nodiscard]] ViewKey key_of(const std::string& photograph, const Sample& sample) {
  for (const Observation& seen : sample.observations) {
    if (seen.camera) continue;
    const std::string frame = seen.features.empty() ? "" : seen.features.front().frame;
    return {photograph, seen.sensor + " " + frame};
  }
  return {photograph, ""};
}

void join_views(Sample& into, Sample from) {
  for (Observation& seen : from.observations) {
    const auto same = std::find_if(into.observations.begin(), into.observations.end(),
                                   [&](const Observation& of) { return of.sensor == seen.sensor; });
    if (same == into.observations.end()) {
      into.observations.push_back(std::move(seen));
    } else if (!seen.camera) {
      join_target(*same, seen, into.source);
    }
  }
  if (into.source != from.source) into.source += ", " + from.source;  // else: of one row of a table
}

}  // namespace
}  // namespace detail

std::vector<Sample> joined_views(std::vector<CameraLooks>& all) {
  std::map<detail::ViewKey, Sample> by_name;
  for (CameraLooks& camera : all) {
    for (Look& look : camera.looks) {
      const std::string name = std::filesystem::path(look.source).stem().string();
      for (Sample& sample : look.samples) {
        const detail::ViewKey key = detail::key_of(name, sample);
        for (Observation& seen : sample.observations) {
          if (seen.camera) seen.sensor = camera.camera;
        }
        const auto at = by_name.find(key);
        if (at == by_name.end()) {
          by_name.emplace(key, std::move(sample));
        } else {
          detail::join_views(at->second, std::move(sample));
        }
      }
      look.samples.clear();
    }
  }
  std::vector<std::pair<std::string, Sample>> sorted;
  for (auto& [key, sample] : by_name) sorted.emplace_back(key.first, std::move(sample));
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return naturally_before(a.first, b.first); });
  std::vector<Sample> samples;
  for (auto& [name, sample] : sorted) samples.push_back(std::move(sample));
  return samples;
}

}  // namespace kinecal
