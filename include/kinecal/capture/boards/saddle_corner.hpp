// A corner at which two black and two white areas meet, as on a checkerboard: a saddle of the
// brightness.
//
// Around it, brightness changes only across lines through the corner p: g . (q - p) = 0 for the
// gradient g at each place q.  Hence  (sum w g g^T) p = sum w g g^T q.
// Source: Foerstner and Guelch, A Fast Operator for Detection and Precise Location of Distinct
// Points, 1987.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "kinecal/capture/image.hpp"

namespace kinecal::detail {

/// The directions of the edges at a corner, and how far all four areas reach along them, pixels.
/// Black is between x and y, and between -x and -y.
struct CornerAxes {
  Eigen::Vector2d x = {0, 0};
  Eigen::Vector2d y = {0, 0};
};

/// How clearly two black and two white areas meet at a place: the darker white minus the brighter
/// black, of 255.
[[nodiscard]] double saddle_contrast(const GrayImage& image, const Eigen::Vector2d& at,
                                     const CornerAxes& axes);

/// The saddle near a place, to a fraction of a pixel.
/// @param reach  how far from it to search, of the axes
/// @returns      nullopt if absent
[[nodiscard]] std::optional<Eigen::Vector2d> find_saddle(const GrayImage& image,
                                                         const Eigen::Vector2d& near,
                                                         const CornerAxes& axes, double reach);

}  // namespace kinecal::detail
