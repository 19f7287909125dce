// Where sensors observed features in a sample: as points or lines of sight in the base.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A feature in the base: a point, or a line of sight if the sensor observes pixels.
struct PlacedFeature {
  Vector3<double> point;                             ///< (3) metres; for a ray, its direction
  Vector3<double> origin = Vector3<double>::Zero();  ///< (3) of the sensor, metres
  Vector3<double> axis = Vector3<double>::UnitZ();   ///< (3) of a camera: forward
  bool seen = true;                                  ///< the feature is not NaN
};

/// True if a feature counts: its numbers are finite.
[[nodiscard]] bool is_seen(const Feature& feature);

/// The feature of an observation that a residual belongs to; nullptr if absent.
[[nodiscard]] const Feature* observed_feature(const Observation& seen, const FeatureLabel& label);

/// The places of a problem's features for given parameters.
class FeaturePlaces {
 public:
  /// @param problem  must outlive it
  /// @param values   of all parameters of the table; must outlive it
  FeaturePlaces(const AnyProblem& problem, ParameterValues values);

  /// What a sensor observed in a sample, feature by feature.
  /// @param sensor  by number in the problem; one that places points, rays or poses
  [[nodiscard]] std::vector<PlacedFeature> placed(int sensor, const Observation& seen,
                                                  const Sample& sample) const;

  /// The pixels at which a camera should see points; NaN where it does not.
  /// @param camera  by number in the problem
  /// @param seen    by the camera in the sample
  /// @param points  (3) metres, in the base
  [[nodiscard]] std::vector<Eigen::Vector2d> pixels(int camera, const Observation& seen,
                                                    const Sample& sample,
                                                    std::span<const PlacedFeature> points) const;

 private:
  [[nodiscard]] Pose<double> base_T_frame(int sensor, const std::string& frame,
                                          const Sample& sample) const;

  const AnyProblem& problem_;
  ParameterValues values_;
  std::vector<std::vector<Corrections<double>>> corrections_;  ///< of each sensor and chain
};

}  // namespace kinecal
