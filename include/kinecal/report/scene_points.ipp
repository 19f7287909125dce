// The observed and predicted features of a sample as points in the base.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/report/scene_pairs.ipp"
#include "kinecal/trust/feature_places.hpp"

namespace kinecal::detail {

/// The points of a problem for given parameters.
class ScenePoints {
 public:
  /// @param values  of all parameters of the table
  ScenePoints(const AnyProblem& problem, std::span<const double> values)
      : problem_(problem), values_(values), places_(problem, values) {}

  /// The pairs that a term compares in a sample, by feature; nullopt where undefined, empty if its
  /// kind cannot be drawn.
  /// @param sample  from AnyProblem::paired()
  [[nodiscard]] std::vector<std::optional<ScenePair>> pairs(const Term& term,
                                                            const Sample& sample) const {
    using enum Quantity;
    const auto quantities = term.quantities;
    const std::vector<Quantity> kinds(quantities.begin(), quantities.end());
    std::vector<std::vector<PlacedFeature>> seen;
    for (const int s : term.sensors) {
      const Observation* observation = sample.observation(sensor(s).mount().name);
      if (observation == nullptr || !is_known(sensor(s))) return {};
      seen.push_back(places_.placed(s, *observation, sample));
    }
    if (kinds == std::vector{plane, plane}) return pairs_of_planes(seen[0], seen[1]);
    std::vector<std::optional<ScenePair>> all;
    for (const std::size_t i : compared(term, sample)) {
      const PlacedFeature &a = seen.front()[i], &b = seen.back()[i];
      if (kinds == std::vector{point}) {
        all.push_back(alone(term, a.point));
      } else if (kinds == std::vector{point, pixel}) {
        all.push_back(pair_at_depth(a, b));
      } else if (kinds == std::vector{ray, ray}) {
        all.push_back(pair_of_rays(a, b));
      } else if (kinds == std::vector{point, point} || kinds == std::vector{pose, pose}) {
        const bool second = !is_camera(term.sensors[0]) && is_camera(term.sensors[1]);
        all.push_back(both(term, second ? b.point : a.point, second ? a.point : b.point));
      }
    }
    return all;
  }

  /// The features that a term compares: those that all of its sensors saw.
  [[nodiscard]] std::vector<std::size_t> compared(const Term& term, const Sample& sample) const {
    std::vector<std::size_t> all;
    std::size_t count = 0;
    std::vector<const Observation*> seen;
    for (const int s : term.sensors) {
      seen.push_back(sample.observation(sensor(s).mount().name));
      if (seen.back() == nullptr) return all;
      count = seen.size() == 1 ? seen[0]->features.size()
                               : std::min(count, seen.back()->features.size());
    }
    for (std::size_t i = 0; i < count; ++i) {
      const bool by_all = std::all_of(seen.begin(), seen.end(),
                                      [i](const auto* of) { return is_seen(of->features[i]); });
      if (by_all) all.push_back(i);
    }
    return all;
  }

 private:
  [[nodiscard]] const MountedSensor& sensor(int s) const {
    return problem_.sensors()[static_cast<std::size_t>(s)];
  }
  [[nodiscard]] bool is_camera(int s) const { return sensor(s).sensor().in_own_frame(); }

  /// Points, rays and poses have a place.
  [[nodiscard]] static bool is_known(const MountedSensor& sensor) {
    const std::optional<Quantity> places = sensor.sensor().places();
    return places && *places != Quantity::reading;
  }

  /// A point compared with a sphere, or with a plane whose foot is computed later.
  [[nodiscard]] std::optional<ScenePair> alone(const Term& term, const Vector3<double>& p) const {
    if (term.options.type != PointToSphere::kType) return scene_pair(p, p);
    const auto v = own<4>(term.parameters);
    return pair_at_distance(p, {v[0], v[1], v[2]}, v[3]);
  }
  [[nodiscard]] std::optional<ScenePair> both(const Term& term, const Vector3<double>& measured,
                                              const Vector3<double>& predicted) const {
    if (term.options.type == PointDistance::kType) {
      return pair_at_distance(measured, predicted, own<1>(term.parameters)[0]);
    }
    if (term.feature_size < 3) return std::nullopt;  // points that need not coincide
    return scene_pair(measured, predicted);
  }

  template <std::size_t N>
  [[nodiscard]] std::array<double, N> own(const std::vector<int>& parameters) const {
    std::array<double, N> all{};
    for (std::size_t i = 0; i < std::min(N, parameters.size()); ++i) {
      if (parameters[i] >= 0) all[i] = values_[static_cast<std::size_t>(parameters[i])];
    }
    return all;
  }

  const AnyProblem& problem_;
  std::span<const double> values_;
  FeaturePlaces places_;
};

}  // namespace kinecal::detail
