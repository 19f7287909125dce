// The observed and predicted features of a sample as points in the base.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/report/scene_pairs.ipp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal::detail {

/// True if a feature counts.
[[nodiscard]] inline bool is_seen(const Feature& feature) {
  return feature.point.allFinite() && (!feature.rotation || feature.rotation->allFinite());
}

/// The points of a problem for given parameters.
class ScenePoints {
 public:
  /// @param values  of all parameters of the table
  ScenePoints(const AnyProblem& problem, std::span<const double> values)
      : problem_(problem), values_(values) {
    for (const MountedSensor& sensor : problem.sensors()) {
      auto& corrections = corrections_.emplace_back();
      for (const SampledChain& chain : sensor.chains()) {
        corrections.push_back(corrections_for(chain.parameters(), values));
      }
    }
  }

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
      seen.push_back(placed(s, *observation, sample));
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

  [[nodiscard]] Pose<double> frame_in_base(int s, std::size_t chain, const Sample& sample) const {
    return sensor(s).chains()[chain].tip(sample, corrections_[static_cast<std::size_t>(s)][chain]);
  }

  /// A measurement in the sensor's frame: a point, or the direction of a line of sight.
  [[nodiscard]] Vector3<double> in_sensor(const MountedSensor& of, const Vector3<double>& recorded,
                                          const std::vector<double>& settings) const {
    const Vector3<double> m = of.sensor().measurement(recorded, settings);
    return of.sensor().place(m, settings, of.own_values(values_));
  }

  [[nodiscard]] std::vector<PlacedFeature> placed(int s, const Observation& seen,
                                                  const Sample& sample) const {
    const MountedSensor& of = sensor(s);
    const bool rays = of.sensor().places() == Quantity::ray;
    const std::vector<double> settings = of.sensor().settings(seen);
    std::map<std::string, Pose<double>> frames;
    std::vector<PlacedFeature> all;
    for (const Feature& feature : seen.features) {
      auto frame = frames.find(feature.frame);
      if (frame == frames.end()) {
        std::size_t chain = 0;
        for (std::size_t c = 1; c < of.chains().size(); ++c) {
          if (same_frame(of.chains()[c].chain().tip, feature.frame)) chain = c;
        }
        frame = frames.emplace(feature.frame, frame_in_base(s, chain, sample)).first;
      }
      const Pose<double>& base_T_sensor = frame->second;
      const Vector3<double> p =
          is_seen(feature) ? in_sensor(of, feature.point, settings) : feature.point;
      all.push_back({rays ? Vector3<double>(base_T_sensor.rotation * p) : base_T_sensor * p,
                     base_T_sensor.translation, base_T_sensor.rotation.col(2), is_seen(feature)});
    }
    return all;
  }

  const AnyProblem& problem_;
  std::span<const double> values_;
  std::vector<std::vector<Corrections<double>>> corrections_;  ///< of each sensor and chain
};

}  // namespace kinecal::detail
