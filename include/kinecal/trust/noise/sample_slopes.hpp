// What residuals change by if samples said something else: other joint positions, other points.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "kinecal/solve/linear_fit.hpp"

namespace kinecal::detail {

/// A fit and the samples that it is of.
struct FittedSamples {
  const AnyProblem& problem;
  const FreeSet& free;
  const LinearFit& fit;
  ParameterValues values;
  std::span<const Sample> samples;
};

/// (rows) derivatives of weighted residuals, by a forward difference; zero if some are undefined.
/// @param move     changes a sample a little
/// @param step     what the difference is divided by
[[nodiscard]] Eigen::VectorXd sample_slopes(const FittedSamples& fitted,
                                            const std::function<void(Sample&)>& move, double step);

/// The same where a sensor measured something else.  Only what the sensor measured is read anew, and only error blocks with the
/// sensor are evaluated.
class MeasurementSlopes {
 public:
  /// @param fitted  outlives this
  explicit MeasurementSlopes(const FittedSamples& fitted);

  /// @param sensor  its name
  /// @param move    changes an observation of it a little: points, one after the other
  /// @returns       as sample_slopes()
  [[nodiscard]] Eigen::VectorXd operator()(const std::string& sensor,
                                           const std::function<void(Observation&)>& move,
                                           double step);

 private:
  const FittedSamples& fitted_;
  std::unique_ptr<AnyProblem> moved_;  ///< with the samples; they are as recorded between calls
};

}  // namespace kinecal::detail
