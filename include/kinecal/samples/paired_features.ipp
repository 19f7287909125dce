// Definitions of paired_features.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/samples/paired_features.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

namespace detail {

// The ids of an observation, and reordering of its features.

/// The ids of an observation in the order of its features; empty if absent.
/// @throws SampleError  if some features lack an id, or two have the same
[[nodiscard]] inline std::vector<int> ids_of(const Observation& seen) {
  std::vector<int> ids;
  for (const Feature& feature : seen.features) {
    if (feature.id) ids.push_back(*feature.id);
  }
  const std::size_t missing = seen.features.size() - ids.size();
  if (ids.empty() || missing > 0) {
    if (ids.empty()) return ids;
    throw SampleError("sensor '" + seen.sensor + "': " + std::to_string(missing) + " of its " +
                      std::to_string(seen.features.size()) +
                      (missing == 1 ? " features has" : " features have") +
                      " no id; give all of them one, or none");
  }
  std::vector<int> sorted = ids;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) {
    throw SampleError("sensor '" + seen.sensor + "': two features have the id " +
                      std::to_string(*twice) + "; each feature needs an id of its own");
  }
  return ids;
}

/// The stand-in for a feature that a sensor did not see.
/// @param near  a feature that it saw, for the frame
[[nodiscard]] inline Feature unseen_feature(const Feature& near, int id) {
  Feature feature{near.frame};
  feature.point.setConstant(std::numeric_limits<double>::quiet_NaN());
  if (near.rotation) feature.rotation = Matrix3<double>::Identity();
  feature.id = id;
  return feature;
}

/// The features of an observation in the order of some ids.
[[nodiscard]] inline std::vector<Feature> in_order(const std::vector<Feature>& features,
                                                   const std::vector<int>& order) {
  std::map<int, const Feature*> by_id;
  for (const Feature& feature : features) by_id.emplace(*feature.id, &feature);
  std::vector<Feature> ordered;
  ordered.reserve(order.size());
  const Feature* near = &features.front();
  for (const int id : order) {
    const auto found = by_id.find(id);
    if (found != by_id.end()) near = found->second;
    ordered.push_back(found != by_id.end() ? *near : unseen_feature(*near, id));
  }
  return ordered;
}

/// The observations of a sample that error blocks compare.
class ObservationPairs {
 public:
  ObservationPairs(const Sample& sample, std::span<const ComparedSensors> blocks)
      : sample_(sample), group_(sample.observations.size()) {
    std::iota(group_.begin(), group_.end(), std::size_t{0});
    for (const ComparedSensors& block : blocks) add(block);
  }

  /// See pair_features().
  [[nodiscard]] std::optional<Sample> paired() const {
    std::optional<Sample> result;
    for (std::size_t g = 0; g < group_.size(); ++g) {
      std::vector<std::size_t> members;
      for (std::size_t o = 0; o < group_.size(); ++o) {
        if (group_[o] == g) members.push_back(o);
      }
      if (members.size() < 2) continue;
      const auto order = order_of(members);
      if (!order) continue;
      if (!result) result = sample_;
      for (const std::size_t o : members) {
        auto& features = result->observations[o].features;
        features = in_order(features, *order);
      }
    }
    return result;
  }

 private:
  /// Indices of the observations of a block's sensors.
  struct Block {
    std::vector<std::size_t> observations;
    bool paired;
  };

  void add(const ComparedSensors& sensors) {
    Block block{{}, sensors.paired};
    for (const std::string& name : sensors.names) {
      const Observation* seen = sample_.observation(name);
      if (seen == nullptr || seen->features.empty()) return;
      block.observations.push_back(static_cast<std::size_t>(seen - sample_.observations.data()));
    }
    for (const std::size_t o : block.observations) {
      if (!block.paired) break;
      const std::size_t joined = group_[o], into = group_[block.observations.front()];
      std::replace(group_.begin(), group_.end(), joined, into);
    }
    blocks_.push_back(std::move(block));
  }

  /// The ids of a group in the wanted order of its features; nullopt: keep their order.
  [[nodiscard]] std::optional<std::vector<int>> order_of(
      const std::vector<std::size_t>& members) const {
    std::map<std::size_t, std::vector<int>> ids;  // of the observations that have them
    std::size_t without = members.front();
    for (const std::size_t o : members) {
      std::vector<int> of_observation = ids_of(sample_.observations[o]);
      if (of_observation.empty()) without = o;
      if (!of_observation.empty()) ids.emplace(o, std::move(of_observation));
    }
    if (ids.empty()) return std::nullopt;
    const std::vector<int>& first = ids.begin()->second;
    if (std::all_of(ids.begin(), ids.end(), [&](const auto& of) { return of.second == first; })) {
      return std::nullopt;
    }
    if (ids.size() < members.size()) {
      throw SampleError("the features of sensor '" + sample_.observations[without].sensor +
                        "' have no ids, those of sensor '" +
                        sample_.observations[ids.begin()->first].sensor +
                        "' have, and are not the same in all sensors; give all features an id");
    }
    for (auto& [o, of_observation] : ids) std::sort(of_observation.begin(), of_observation.end());
    return compared(ids);
  }

  /// The ids that some block can compare, ascending; without any, all ids, so that features
  /// are not paired by place.
  [[nodiscard]] std::vector<int> compared(
      const std::map<std::size_t, std::vector<int>>& ids) const {
    std::vector<int> all, kept;
    for (const auto& [o, of_observation] : ids) {
      all.insert(all.end(), of_observation.begin(), of_observation.end());
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    for (const int id : all) {
      const auto sees = [&](std::size_t o) {
        const auto of = ids.find(o);
        return of != ids.end() && std::binary_search(of->second.begin(), of->second.end(), id);
      };
      const auto takes = [&](const Block& block) {
        const auto& seen = block.observations;
        return block.paired ? std::all_of(seen.begin(), seen.end(), sees)
                            : std::any_of(seen.begin(), seen.end(), sees);
      };
      if (std::any_of(blocks_.begin(), blocks_.end(), takes)) kept.push_back(id);
    }
    return kept.empty() ? all : kept;
  }

  const Sample& sample_;
  std::vector<std::size_t> group_;  ///< by observation
  std::vector<Block> blocks_;       ///< those whose sensors all observed something
};

}  // namespace detail

KINECAL_INLINE bool has_ids(const Sample& sample) {
  for (const Observation& seen : sample.observations) {
    for (const Feature& feature : seen.features) {
      if (feature.id) return true;
    }
  }
  return false;
}

KINECAL_INLINE std::optional<Sample> pair_features(const Sample& sample,
                                                   std::span<const ComparedSensors> blocks) {
  if (!has_ids(sample)) return std::nullopt;
  return detail::ObservationPairs(sample, blocks).paired();
}

KINECAL_INLINE bool ids_are_disjoint(const Sample& sample,
                                     const std::vector<std::string>& sensors) {
  std::map<int, std::size_t> times;  // number of observations with an id
  for (const std::string& sensor : sensors) {
    const Observation* seen = sample.observation(sensor);
    if (seen == nullptr || seen->features.empty()) return false;
    for (const Feature& feature : seen->features) {
      if (!feature.id) return false;
      ++times[*feature.id];
    }
  }
  return std::none_of(times.begin(), times.end(),
                      [&](const auto& id) { return id.second >= sensors.size(); });
}

}  // namespace kinecal
