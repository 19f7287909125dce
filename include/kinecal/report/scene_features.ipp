// The features of a scene: measured and predicted points before and after, and their errors.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/report/robot_scene.hpp"
#include "kinecal/report/scene_points.ipp"
#include "kinecal/text/reading.hpp"

namespace kinecal::detail {

/// Residuals of the shown samples: by sample and term.
using SceneResiduals = std::map<std::pair<int, int>, std::vector<double>>;

[[nodiscard]] inline SceneResiduals scene_residuals(const AnyProblem& problem,
                                                    std::span<const double> values,
                                                    const std::vector<std::size_t>& shown) {
  SceneResiduals all;
  (void)evaluate(problem, values, nullptr, [&](int t, int sample, const TermResiduals& of) {
    if (!std::binary_search(shown.begin(), shown.end(), static_cast<std::size_t>(sample))) return;
    all[{sample, t}].assign(of.residual.begin(), of.residual.end());
  });
  return all;
}

/// Points of blocks that compare with a plane: their feet are computed once all points are known.
[[nodiscard]] inline bool is_point_to_plane(const Term& term) {
  return term.options.type == PointToPlane::kType;
}

/// True if a block's single points can be drawn: with a sphere or a plane.
[[nodiscard]] inline bool can_be_drawn(const Term& term) {
  return term.quantities.size() != 1 || is_point_to_plane(term) ||
         term.options.type == PointToSphere::kType;
}

/// Limits the features of a sample: the worst quarter, others evenly.
inline std::size_t thin_features(std::vector<SceneFeature>& features, std::size_t most) {
  const std::size_t all = features.size();
  if (all <= most) return all;
  std::vector<std::size_t> order(all);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return features[a].distance.value_or(0.0) > features[b].distance.value_or(0.0);
  });
  const std::size_t worst = most / 4;
  std::sort(order.begin() + static_cast<std::ptrdiff_t>(worst), order.end());
  std::vector<std::size_t> chosen(order.begin(),
                                  order.begin() + static_cast<std::ptrdiff_t>(worst));
  const std::size_t others = all - worst, wanted = most - worst;
  for (std::size_t i = 0; i < wanted; ++i) chosen.push_back(order[worst + i * others / wanted]);
  std::sort(chosen.begin(), chosen.end());
  std::vector<SceneFeature> kept;
  for (const std::size_t i : chosen) kept.push_back(std::move(features[i]));
  features = std::move(kept);
  return most;
}

/// Adds the features of a problem's samples to a scene.
class SceneFeatures {
 public:
  SceneFeatures(const AnyProblem& problem, std::span<const double> before,
                std::span<const double> after, const std::vector<std::size_t>& shown)
      : problem_(problem),
        points_{ScenePoints(problem, before), ScenePoints(problem, after)},
        residuals_{scene_residuals(problem, before, shown), scene_residuals(problem, after, shown)},
        planes_(static_cast<std::size_t>(problem.num_terms())) {}

  [[nodiscard]] std::vector<SceneFeature> of(int sample, const Sample& recorded) {
    const std::optional<Sample> paired = problem_.paired(recorded);
    std::vector<SceneFeature> features;
    for (int t = 0; t < problem_.num_terms(); ++t) {
      const Term& term = problem_.term(t);
      if (!can_be_drawn(term)) continue;
      const std::size_t first = features.size();
      for (std::size_t when = 0; when < 2; ++when) {
        const auto residuals = residuals_[when].find({sample, t});
        if (residuals == residuals_[when].end()) continue;  // it does not apply, or is undefined
        const auto pairs = points_[when].pairs(term, paired ? *paired : recorded);
        if (features.size() == first) add(t, sample, pairs.size(), features);
        for (std::size_t i = 0; i < std::min(pairs.size(), features.size() - first); ++i) {
          set(term, when, i, residuals->second, pairs[i], features[first + i]);
        }
      }
    }
    std::erase_if(features, [](const SceneFeature& of) { return !of.before && !of.after; });
    return features;
  }

  /// Sets the feet of points on planes.
  void set_feet(RobotScene& scene) const {
    std::vector<std::optional<Vector3<double>>> normals;
    for (const PlaneOfDistances& plane : planes_) normals.push_back(plane.normal());
    for (SceneSample& sample : scene.samples) {
      for (SceneFeature& feature : sample.features) {
        const auto t = static_cast<std::size_t>(feature.block);
        if (!is_point_to_plane(problem_.term(feature.block))) continue;
        move(feature.before, normals[t]);
        move(feature.after, normals[t]);
      }
      std::erase_if(sample.features,
                    [](const SceneFeature& of) { return !of.before && !of.after; });
    }
  }

 private:
  void add(int t, int sample, std::size_t count, std::vector<SceneFeature>& features) const {
    const bool plane = !problem_.term(t).pairs_features();
    for (std::size_t i = 0; i < count; ++i) {
      const auto n = static_cast<std::ptrdiff_t>(i);
      features.push_back(
          {.block = t,
           .name = plane ? fmt::format("point {}", i + 1) : problem_.feature(t, sample, n).text(),
           .before = {},
           .after = {}});
    }
  }

  void set(const Term& term, std::size_t when, std::size_t i, const std::vector<double>& residuals,
           const std::optional<ScenePair>& pair, SceneFeature& feature) {
    (when == 0 ? feature.before : feature.after) = pair;
    const auto size = static_cast<std::size_t>(term.feature_size);
    if (!term.pairs_features() || (i + 1) * size > residuals.size()) return;
    double squares = 0.0;
    for (std::size_t k = i * size; k < (i + 1) * size; ++k) squares += residuals[k] * residuals[k];
    if (pair && is_point_to_plane(term)) {
      const ScenePoint& p = (*pair)[0];
      planes_[static_cast<std::size_t>(feature.block)].add({p[0], p[1], p[2]}, residuals[i]);
      // The distance is kept here until the normal is known.
      (when == 0 ? feature.before : feature.after) = ScenePair{p, {residuals[i], 0.0, 0.0}};
    }
    if (when == 0) return;
    feature.distance = std::sqrt(squares);
    feature.error = reading(*feature.distance, term.options.unit);
  }

  static void move(std::optional<ScenePair>& pair, const std::optional<Vector3<double>>& normal) {
    if (!pair) return;
    if (!normal) {
      pair.reset();
      return;
    }
    auto& [p, foot] = *pair;
    const double off = foot[0];
    for (std::size_t k = 0; k < 3; ++k) foot[k] = p[k] - off * (*normal)(static_cast<int>(k));
  }

  const AnyProblem& problem_;
  std::array<ScenePoints, 2> points_;
  std::array<SceneResiduals, 2> residuals_;
  std::vector<PlaneOfDistances> planes_;  ///< of each term
};

inline void add_features(const AnyProblem& problem, const ParameterTable& table,
                         std::span<const Sample> samples, const std::vector<std::size_t>& shown,
                         std::size_t most, RobotScene& scene) {
  std::vector<double> before, after;
  for (const Parameter& parameter : table) {
    before.push_back(parameter.initial);
    after.push_back(parameter.value);
  }
  SceneFeatures features(problem, before, after, shown);
  std::size_t all = 0, kept = 0;
  const std::size_t each = std::max<std::size_t>(4, most / std::max<std::size_t>(1, shown.size()));
  for (std::size_t n = 0; n < shown.size(); ++n) {
    SceneSample& sample = scene.samples[n];
    sample.features = features.of(static_cast<int>(shown[n]), samples[shown[n]]);
    all += sample.features.size();
    kept += thin_features(sample.features, each);
  }
  features.set_feet(scene);
  if (kept == all) return;
  scene.thinned +=
      (scene.thinned.empty() ? "" : ", ") + fmt::format("{} of {} features in them", kept, all);
}

}  // namespace kinecal::detail
