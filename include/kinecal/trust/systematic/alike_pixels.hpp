// Residuals of a camera that depend on the place in its image: a lens whose shape its model does not have.
//
// Residuals of a good camera point nowhere in particular.  Let m_c be the mean residual in cell c of the image, with n_c
// features.  Features of one view err together, so |m_c|^2 is estimated from pairs of different views only:
//
//   m_c^2 = (|sum_v S_cv|^2 - sum_v |S_cv|^2) / (n_c^2 - sum_v n_cv^2)      S_cv the sum of residuals of view v in c
//   s^2 = sum n_c m_c^2 / sum n_c                                           the part that depends on the place
//
// If it is chance, each view may as well have the opposite sign: s^2 is compared with that of random signs.
// Source: Fisher, The Design of Experiments, 1935, 21, for the test by signs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/uncertainty/projection_map.hpp"

namespace kinecal {

/// How far residuals of a camera depend on the place in its image.
struct AlikePixels {
  std::string sensor;   ///< the camera
  double all = 0.0;     ///< root of the mean squared residual of a feature, pixels
  double alike = 0.0;   ///< s, the part of it that depends on the place, pixels; 0: none
  double chance = 1.0;  ///< probability of such a part, or a larger one
  std::string region;   ///< where it is largest: "upper left"
  std::array<double, 2>
      there{};  ///< mean residual in the cell where it is largest, pixels: predicted less observed
  std::array<double, 2> pixel{};  ///< the middle of that cell
};

/// Measures it for each camera that is compared with something else.
/// @param maps     the images of the cameras
/// @param samples  those of the problem, in their order
[[nodiscard]] std::vector<AlikePixels> alike_pixels(const AnyProblem& problem, const LinearFit& fit,
                                                    const std::vector<ProjectionMap>& maps,
                                                    std::span<const Sample> samples);

}  // namespace kinecal
