// What a sample should have measured if the robot were as the values say.
//
//   for (const Prediction& p : predict(problem, values, sample)) {
//     std::cout << p.block << ", " << p.feature.text() << ": " << p.residual.transpose() << '\n';
//   }
//
// A residual is the prediction less the measurement, in the unit of its block: metres in the base, or pixels.  For a
// camera there is the pixel, too.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"

namespace kinecal {

/// What an error block compares of one feature, or of one pair of planes.
struct Prediction {
  std::string block;         ///< name of the error block
  FeatureLabel feature;      ///< of the block's first sensor: place in its list, id
  Eigen::VectorXd residual;  ///< (residuals of a feature) unweighted, in the block's unit
  /// (2) pixels: where the camera should see the point; empty if the block does not compare pixels.
  std::optional<Eigen::Vector2d> pixel = {};
};

/// Predicts a sample: block by block, feature by feature.  Features that are not numbers are left out.
/// @param problem  its samples do not matter
/// @param values   of all parameters of the table
/// @param sample   of the robot, as for AnyProblem::add_sample()
/// @throws SampleError            if the sample does not match the problem
/// @throws std::domain_error      with block and sample, if a residual is undefined, such as that of a
///                                point that the camera does not see
/// @throws std::invalid_argument  if the number of values is not that of the table's parameters
[[nodiscard]] std::vector<Prediction> predict(const AnyProblem& problem, ParameterValues values,
                                              const Sample& sample);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/evaluation/predict.ipp"
#endif
