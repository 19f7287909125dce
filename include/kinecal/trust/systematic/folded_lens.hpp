// Lenses that fold over inside the image: from some radius on, the image of points that are farther from the
// axis comes nearer to the center again, or is missing.
//
// Polynomials do so where no feature held them.  Whoever rectifies such an image, or projects into it, gets one place
// for two directions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/parameters/parameter_values.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A lens that folds over inside the image.
struct FoldedLens {
  std::string sensor;     ///< the camera
  double radius = 0.0;    ///< from the principal point, pixels, where it folds first
  double corner = 0.0;    ///< of the farthest corner of the image, pixels
  double farthest = 0.0;  ///< of the farthest feature, pixels

  /// True if features show that it folds; else no feature held the polynomial there.
  [[nodiscard]] bool is_among_features() const { return radius < 1.05 * farthest; }
};

/// The cameras of raw images whose lens folds over inside the image, or before the farthest feature where the size of the
/// image is not known.
/// @param free     only cameras with a free coefficient: the others are as they were given
/// @param values   of all parameters of the table: the solution
/// @param samples  those of the problem, in their order
[[nodiscard]] std::vector<FoldedLens> folded_lenses(const AnyProblem& problem, const FreeSet& free,
                                                    ParameterValues values,
                                                    std::span<const Sample> samples);

namespace detail {

/// True if a step frees a coefficient of a camera's lens.
[[nodiscard]] bool frees_lens(const MountedSensor& camera, const FreeSet& free);

}  // namespace detail

}  // namespace kinecal
