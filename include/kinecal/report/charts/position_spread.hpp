// How far off the position is and how it varies between calibrations, with how many poses: of a study.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// Calibrations with one number of poses.
struct PositionSpread {
  int poses = 0;
  double varied = 0.0;     ///< standard deviation of the calibrations, metres
  double predicted = 0.0;  ///< by the covariance, metres
  double off = 0.0;        ///< error of the calibrations, RMS, metres
};

/// Error, varied and predicted position over the number of poses.
/// @param points  by number of poses, ascending
[[nodiscard]] Chart position_spread_chart(const std::vector<PositionSpread>& points);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/charts/position_spread.ipp"
#endif
