// Definition of predict.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

#include "kinecal/evaluation/predict.hpp"

namespace kinecal {

namespace detail {

/// The pose in the base of the tip of a sensor's chain to a frame.
[[nodiscard]] inline Pose<double> tip_pose(const MountedSensor& sensor, std::size_t chain,
                                           const Sample& sample, ParameterValues values) {
  const SampledChain& way = sensor.chains()[chain];
  return way.tip(sample, corrections_for<double>(way.parameters(), values));
}

/// The pixel at which a camera should see a feature of another sensor.
/// @param i  of both, in the order in which blocks pair features
[[nodiscard]] inline Eigen::Vector2d predicted_pixel(const MountedSensor& points,
                                                     const MountedSensor& camera,
                                                     const Sample& sample, std::size_t i,
                                                     ParameterValues values) {
  const Observation& of_points = *sample.observation(points.mount().name);
  const ObservationNumbers numbers = points.numbers(sample, of_points);
  const std::size_t width = numbers.measured.size() / numbers.usable.size();
  const Vector3<double> measured(&numbers.measured[i * width]);
  const Vector3<double> p_base =
      tip_pose(points, numbers.chain[i], sample, values) *
      points.sensor().place(measured, numbers.settings, points.own_values(values));
  const Observation& seen = *sample.observation(camera.mount().name);
  return camera.sensor().predict(tip_pose(camera, 0, sample, values).inverse() * p_base,
                                 camera.sensor().settings(seen), camera.own_values(values));
}

}  // namespace detail

KINECAL_INLINE std::vector<Prediction> predict(const AnyProblem& problem, ParameterValues values,
                                               const Sample& sample) {
  const std::unique_ptr<AnyProblem> one = problem.without_samples();
  one->add_sample(sample);
  const std::optional<Sample> in_order = one->paired(sample);
  const Sample& ordered = in_order ? *in_order : sample;
  std::vector<Prediction> all;
  const auto add = [&](int t, int, const TermResiduals& rows) {
    const Term& term = one->term(t);
    std::size_t place = 0;  // in the order of the block's features
    for (Eigen::Index row = 0; row < rows.residual.size(); row += term.feature_size) {
      Prediction& p = all.emplace_back();
      p.block = term.name;
      p.feature = one->feature(t, 0, row / term.feature_size);
      p.residual = rows.residual.segment(row, term.feature_size);
      if (term.quantities.empty() || term.quantities.back() != Quantity::pixel) continue;
      const MountedSensor& points = one->sensors()[static_cast<std::size_t>(term.sensors[0])];
      const MountedSensor& camera = one->sensors()[static_cast<std::size_t>(term.sensors[1])];
      const auto is_number = [&](const MountedSensor& sensor) {
        return ordered.observation(sensor.mount().name)->features[place].point.allFinite();
      };
      while (!is_number(points) || !is_number(camera)) ++place;
      p.pixel = detail::predicted_pixel(points, camera, ordered, place++, values);
    }
  };
  if (const auto undefined = evaluate(*one, values, nullptr, add)) {
    throw std::domain_error(undefined->source + ": error block '" + undefined->term +
                            "': a residual is undefined, such as that of a point that the camera "
                            "does not see");
  }
  return all;
}

}  // namespace kinecal
