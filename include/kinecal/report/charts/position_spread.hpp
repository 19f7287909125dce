// Error and scatter of the position between calibrations over the number of poses, for a study.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// Calibrations with one number of poses.
struct PositionSpread {
  int poses = 0;
  double varied = 0.0;     ///< standard deviation of the calibrations, metres
  double predicted = 0.0;  ///< according to the covariance, metres
  double off = 0.0;        ///< error of the calibrations, RMS, metres
};

/// Error, scatter and predicted scatter of the position over the number of poses.
/// @param points  by number of poses, ascending
[[nodiscard]] Chart position_spread_chart(const std::vector<PositionSpread>& points);

}  // namespace kinecal
