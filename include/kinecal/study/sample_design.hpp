// The covariance that a calibration will have, before anybody captures its samples.
//
// A sample with rows r = J dz + sum d_x e_x, over all measured numbers x and all joints, each with
// an error e_x of one standard deviation along d_x = dr/dx, contributes to
//
//   H = sum J^T W^2 J      V = sum (J^T W^2 d_x)(J^T W^2 d_x)^T      C = H^+ V H^+
//
// W are the weights of the configuration, as in the solver.  So C is the covariance of the estimate
// even if noise depends on distance, or if joint errors make the features of a sample err together.
// Source: Huber, Robust Statistics, 1981, 6.3.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/study/exact_samples.hpp"
#include "kinecal/study/measurement_noise.hpp"
#include "kinecal/trust/plain_matrix.hpp"

namespace kinecal {

/// The contribution of one sample; each matrix (free x free), by the free parameters.
struct SampleDesign {
  PlainMatrix information;  ///< H
  PlainMatrix scores;       ///< V
};

/// The contributions of some samples and of the priors of a problem.
struct StudyDesign {
  std::vector<SampleDesign> samples;  ///< in their order
  PlainMatrix prior;                  ///< (free x free) of all priors, per sample
};

/// Where a target is.
enum class Targets {
  held,  ///< on its link, at known points: no unknowns, as for the Fetch
  free   ///< anywhere: six unknowns per sample, two sensors of equal weight, as for the PR2
};

/// The contributions of exact samples near the true robot.
///
/// With free targets, each sensor has its own residuals to points X of the target, and X fits both:
/// |c - X|^2 + |a - X|^2.  If X may move by t, their difference d leaves
///
///   min over t = d^T (I - P / 2) d        P: projection onto the rows that t moves
///
/// so H = J^T (I - P / 2) J, and V likewise.
/// @param values   of all parameters of the table: the true robot
/// @param samples  exact ones: see exact_samples()
/// @throws StudyError  if a residual is undefined
[[nodiscard]] StudyDesign study_design(const MakeProblem& make, const FreeSet& free,
                                       ParameterValues values, std::span<const Sample> samples,
                                       const MeasurementNoise& noise,
                                       Targets targets = Targets::held);

/// The expected scatter of repeated calibrations with some of these samples.  Priors hold
/// parameters, but do not scatter.
struct ExpectedUncertainty {
  PlainMatrix covariance;  ///< (free x free); zero along undetermined directions
  PlainMatrix deviation;   ///< of each free parameter; infinite if it is not determined
  int determined = 0;      ///< number of directions that samples and priors determine
};

/// @param chosen  indices of samples
[[nodiscard]] ExpectedUncertainty expected_uncertainty(const StudyDesign& design,
                                                       std::span<const int> chosen);

/// The mean squared error of a quantity with a given covariance: trace(goal C).
/// @param goal  (free x free) mean of J^T J: see position_goal()
[[nodiscard]] double expected_variance(const ExpectedUncertainty& expected,
                                       const PlainMatrix& goal);

}  // namespace kinecal
