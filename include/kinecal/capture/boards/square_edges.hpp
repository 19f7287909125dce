// The sharpness of a printed target in an image, measured across the edges of its squares.
//
// The brightness across an edge, averaged along it, rises from dark to bright.  The width is this
// rise over the steepest slope: about 1 pixel for a sharp image, 2.5 s for a Gaussian blur of s
// pixels, n for a smear over n pixels while the arm still moves.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/capture/image.hpp"

namespace kinecal {

/// Brightness between pixels, 0 to 255; outside the image, that of its border.
[[nodiscard]] double brightness_at(const GrayImage& image, const Eigen::Vector2d& pixel);

/// The brightness across one edge.
struct EdgeMeasure {
  double width = 0.0;     ///< pixels
  double contrast = 0.0;  ///< bright side minus dark side, of 255
  double dark = 0.0;      ///< of the dark side, 0 to 255
  double bleed = 0.0;     ///< from the edge's true position into the dark side, pixels
  double length = 0.0;    ///< pixels
};

/// Measures the edge from corner a to corner b.
/// @param a, b   (2) pixels
/// @param reach  distance to either side, pixels
/// @returns      nullopt if both sides are about as bright: no edge, or glare
[[nodiscard]] std::optional<EdgeMeasure> measure_edge(const GrayImage& image,
                                                      const Eigen::Vector2d& a,
                                                      const Eigen::Vector2d& b, double reach);

/// Requirements on the image of a target.  Widths and bleeds may be larger in images of many pixels: up to
/// 3 and 1 % of an edge's length.
struct TargetQuality {
  double min_square = 8.0;      ///< side of the smallest square, pixels
  double max_edge_width = 6.0;  ///< pixels: blur by about 2.4, or a smear of 6
  double max_glare = 0.02;      ///< saturated fraction of the dark squares
  double max_bleed = 1.0;       ///< of white into dark squares, pixels: more is over-exposed
};

/// Why edges are not good enough: "blurred: edges are 7.2 pixels wide, at most 6 are allowed";
/// empty if they are.  Judges the two directions separately, because a moving arm smears only one
/// of them.
/// @param edges  (2) of either direction
[[nodiscard]] std::string edge_fault(const std::vector<EdgeMeasure> (&edges)[2],
                                     const TargetQuality& quality);

namespace detail {

/// A number with one decimal.
[[nodiscard]] std::string one_digit(double value);

}  // namespace detail

}  // namespace kinecal
