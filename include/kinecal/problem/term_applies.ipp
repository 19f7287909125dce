// Decides which terms apply to a sample.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <map>

#include "kinecal/errors/plane_fit.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

namespace detail {

/// The observation of each sensor of a problem in a sample.
using Observed = std::vector<std::optional<ObservationNumbers>>;

/// The observations of a term's sensors in a sample, in their order.
[[nodiscard]] inline std::vector<const ObservationNumbers*> observations_of(
    const Term& term, const Observed& observed) {
  std::vector<const ObservationNumbers*> seen;
  for (const int s : term.sensors) seen.push_back(&*observed[static_cast<std::size_t>(s)]);
  return seen;
}

/// 1 / sigma of each feature, 0 for one without a sigma; empty if no feature has one.  Variances of
/// several sensors add up.  A pixel block takes those of the camera, which are in pixels.
[[nodiscard]] inline std::vector<double> precisions_of(const Term& term, const Observed& observed) {
  const auto seen = observations_of(term, observed);
  const auto quantities = term.quantities;
  const bool of_pixels =
      std::find(quantities.begin(), quantities.end(), Quantity::pixel) != quantities.end();
  std::vector<double> variances;
  for (std::size_t s = 0; s < seen.size(); ++s) {
    const std::vector<double>& variance = seen[s]->variance;
    if (variance.empty() || (of_pixels && quantities[s] != Quantity::pixel)) continue;
    variances.resize(variance.size(), 0.0);
    for (std::size_t i = 0; i < variance.size(); ++i) variances[i] += variance[i];
  }
  for (double& variance : variances) {
    variance = variance > 0.0 ? 1.0 / std::sqrt(variance) : 0.0;
  }
  return variances;
}

/// Labels of the features that a term compares in a sample; empty if they are 0, 1, 2 ... without
/// ids.
/// @param features  the compared ones
/// @param recorded  the observation of its first sensor
/// @param paired    the same, after pairing
[[nodiscard]] inline std::vector<FeatureLabel> labels_of(const Term& term,
                                                         const std::vector<std::size_t>& features,
                                                         const Observation& recorded,
                                                         const Observation& paired) {
  std::vector<FeatureLabel> labels;
  if (!term.pairs_features()) return labels;  // they form one plane
  std::map<int, int> places;                  // place where each was recorded, by id
  for (std::size_t i = 0; &recorded != &paired && i < recorded.features.size(); ++i) {
    const std::optional<int>& id = recorded.features[i].id;
    if (id) places.emplace(*id, static_cast<int>(i));
  }
  bool plain = true;
  for (const std::size_t i : features) {
    const std::optional<int>& id = paired.features[i].id;
    const auto place = id ? places.find(*id) : places.end();
    labels.push_back({place != places.end() ? place->second : static_cast<int>(i), id});
    plain = plain && !id && i + 1 == labels.size();
  }
  if (plain) labels.clear();
  return labels;
}

/// The values of the sample's conditions that a term takes.
[[nodiscard]] inline std::vector<double> conditions_of(const Term& term, const Sample& sample) {
  std::vector<double> values;
  for (const std::string_view wanted : term.conditions) {
    const std::string name(wanted);
    const auto found = sample.conditions.find(name);
    if (found == sample.conditions.end()) {
      std::vector<std::string> names;
      for (const auto& [known, value] : sample.conditions) names.push_back(known);
      throw SampleError("error block '" + term.name + "': condition '" + name +
                        "' is not in the sample" + did_you_mean(name, names));
    }
    if (!std::isfinite(found->second)) {
      throw SampleError("error block '" + term.name + "': condition '" + name +
                        "' is not a finite number");
    }
    values.push_back(found->second);
  }
  return values;
}

/// Why the features of a sensor in one sample do not determine a plane; empty if they do.
[[nodiscard]] inline std::string why_no_plane(const AnySensor& sensor,
                                              const ObservationNumbers& seen) {
  std::vector<Vector3<double>> points;
  for (std::size_t i = 0; i < seen.usable.size(); ++i) {
    if (seen.usable[i] == 0.0) continue;
    if (seen.chain[i] != seen.chain[0]) return "the points of a plane are in several frames";
    const double* measured = &seen.measured[3 * i];
    points.push_back(sensor.place({measured[0], measured[1], measured[2]}, seen.settings));
  }
  if (points.size() < 3) return "a plane takes three points or more";
  return PlaneFit<double>(points).determined() ? "" : "its points span no plane";
}

/// The features that a term compares in a sample: those that all of its sensors observed.  Empty if
/// the term does not apply; one entry for planes.
/// @throws SampleError  if it should apply, but cannot
[[nodiscard]] inline std::vector<std::size_t> compared_features(
    const Term& term, const std::vector<MountedSensor>& sensors, const Sample& sample,
    const Observed& observed) {
  const std::string& beside = term.options.beside;
  if (!beside.empty() && sample.observation(beside) == nullptr) return {};
  const auto observing = std::count_if(
      sample.observations.begin(), sample.observations.end(),
      [&](const Observation& o) { return !o.features.empty() && o.sensor != beside; });
  if (term.options.exclusive && observing != std::ssize(term.sensors)) return {};
  for (const int s : term.sensors) {
    if (!observed[static_cast<std::size_t>(s)]) return {};
  }
  const auto seen = observations_of(term, observed);
  const auto sensor = [&](std::size_t i) -> const MountedSensor& {
    return sensors[static_cast<std::size_t>(term.sensors[i])];
  };
  const auto name = [&](std::size_t i) { return sensor(i).mount().name; };
  for (std::size_t i = 1; i < seen.size() && term.pairs_features(); ++i) {
    if (seen[i]->usable.size() == seen[0]->usable.size()) continue;
    throw SampleError("error block '" + term.name + "': sensor '" + name(0) + "' has " +
                      std::to_string(seen[0]->usable.size()) + " features, sensor '" + name(i) +
                      "' has " + std::to_string(seen[i]->usable.size()) +
                      "; give them ids, so that they are paired by id, not by place");
  }
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (term.quantities[i] != Quantity::plane) continue;
    if (!seen[i]->variance.empty()) {
      throw SampleError("error block '" + term.name + "': a feature of sensor '" + name(i) +
                        "' has a sigma; all features together are one plane, so the sigma of the "
                        "block counts and features must have none");
    }
    if (const std::string why = why_no_plane(sensor(i).sensor(), *seen[i]); !why.empty()) {
      throw SampleError("error block '" + term.name + "': " + why);
    }
  }
  if (!term.pairs_features()) return {0};
  std::vector<std::size_t> features;
  for (std::size_t i = 0; i < seen[0]->usable.size(); ++i) {
    const auto has_it = [i](const auto* of_sensor) { return of_sensor->usable[i] > 0.0; };
    if (std::all_of(seen.begin(), seen.end(), has_it)) features.push_back(i);
  }
  return features;
}

}  // namespace detail

}  // namespace kinecal
