// Residuals of a camera that grow with the distance from the center of its image: its lens is not as it was taken.
//
// Let the pixels be farther from the principal point c than they were measured, by
//
//   a (p - c) |p - c|^2 / R^3      R the distance of the farthest feature: a pixels there
//
// which is the first term of a lens, k1 = a f^2 / R^3, and fit again beside the free parameters.  A wrong focal length or
// principal point that is held looks alike: the evidence is what is left of a beside these.  Features of one view err
// together, so its variance is that over poses left out in turn (jackknife).  A pattern is reported if chance is
// excluded, if a is larger than the noise and half a pixel, and if the noise of the camera falls to 95 %.  The reported
// pixels are the part of a that free parameters have not absorbed: it is what residuals show.  A lens of which a
// coefficient is free fits as well as its model can, and has no pattern.
// Source: Brown, Decentering Distortion of Lenses, 1966; MacKinnon, White, Some heteroskedasticity-consistent
// covariance matrix estimators, 1985 (jackknife).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>

#include "kinecal/samples/sample.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/pose_groups.hpp"

namespace kinecal {

/// What lens the pixels of a camera were taken to have.
enum class TakenLens {
  none,      ///< camera_info has no distortion
  given,     ///< that of camera_info
  rectified  ///< none: camera_info has one, but the image is taken as rectified
};

/// A lens that differs from what it was taken as.
struct LensPattern {
  std::string sensor;   ///< the camera
  double pixels = 0.0;  ///< by which residuals are farther from the center at `radius`
  double radius = 0.0;  ///< distance from the center where that is so: the farthest feature, pixels
  double k1 = 0.0;      ///< of the lens, on top of what it was taken as
  double noise_left = 1.0;  ///< ratio of the noise with k1 to that without
  TakenLens taken = TakenLens::none;
};

/// The camera whose lens explains the residuals best; nullopt if none does.
/// @param fit      at the solution
/// @param values   of all parameters of the table: the solution
/// @param samples  those of the problem, in their order
[[nodiscard]] std::optional<LensPattern> lens_pattern(const AnyProblem& problem,
                                                      const FreeSet& free, const LinearFit& fit,
                                                      ParameterValues values,
                                                      std::span<const Sample> samples,
                                                      const PoseGroups& poses);

}  // namespace kinecal
