// What samples are worth before anybody captures them: the covariance that a calibration will have.
//
// A sample with rows r = J dz + sum d_x e_x, over all measured numbers x and all joints, each with an
// error e_x of one standard deviation along d_x = dr/dx, adds to
//
//   H = sum J^T W^2 J      V = sum (J^T W^2 d_x)(J^T W^2 d_x)^T      C = H^+ V H^+
//
// W are the weights of the configuration, as the solver has them: so C is the covariance of the
// estimate even if the noise depends on distance, or features of a sample err together because its
// joints do.
// Source: Huber, Robust Statistics, 1981, 6.3.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/study/exact_samples.hpp"
#include "kinecal/study/measurement_noise.hpp"
#include "kinecal/trust/plain_matrix.hpp"

namespace kinecal {

/// What one sample adds; each matrix (free x free), by the free parameters.
struct SampleDesign {
  PlainMatrix information;  ///< H
  PlainMatrix scores;       ///< V
};

/// What some samples and the priors of a problem add.
struct StudyDesign {
  std::vector<SampleDesign> samples;  ///< in their order
  PlainMatrix prior;                  ///< (free x free) of all priors, for one sample
};

/// Where a target is.
enum class Targets {
  held,  ///< on its link, at points that are known: no unknowns, as the Fetch's
  free  ///< anywhere: six unknowns for each sample, seen by two sensors that count alike, as the PR2's
};

/// What exact samples are worth near the true robot.
///
/// With free targets each sensor has residuals of its own towards points X of the target, and X follows
/// both: |c - X|^2 + |a - X|^2.  Where X may be moved by t, this leaves of their difference d
///
///   min over t = d^T (I - P / 2) d        P: projection onto the rows that t moves
///
/// so H = J^T (I - P / 2) J, and V likewise.
/// @param values   of all parameters of the table: the true robot
/// @param samples  exact ones: see exact_samples()
/// @throws StudyError  if a residual is undefined
[[nodiscard]] StudyDesign study_design(const MakeProblem& make, const FreeSet& free,
                                       std::span<const double> values,
                                       std::span<const Sample> samples,
                                       const MeasurementNoise& noise,
                                       Targets targets = Targets::held);

/// How a calibration with some of these samples will vary if it is repeated.  Priors hold
/// parameters, but do not vary.
struct ExpectedUncertainty {
  PlainMatrix covariance;  ///< (free x free); zero along what nothing determines
  PlainMatrix deviation;   ///< of each free parameter; infinite if it is not determined
  int determined = 0;      ///< directions that samples and priors determine
};

/// @param chosen  indices of samples
[[nodiscard]] ExpectedUncertainty expected_uncertainty(const StudyDesign& design,
                                                       std::span<const int> chosen);

/// The mean squared error of something with a covariance: trace(goal C).
/// @param goal  (free x free) mean of J^T J: see position_goal()
[[nodiscard]] double expected_variance(const ExpectedUncertainty& expected,
                                       const PlainMatrix& goal);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/study/sample_design.ipp"
#endif
