// Whether calibrations vary as the covariance predicts: of a study of many.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// Calibrations with one number of poses.
struct SpreadSeries {
  std::string name;            ///< "100 poses"
  int freedom = 0;             ///< degrees of freedom: calibrations less those that give the means
  std::vector<double> ratios;  ///< of each parameter, see SpreadRatios; NaN: not determined
};

/// Standard deviation of calibrations by the one that the covariance predicts.
struct SpreadRatios {
  std::vector<std::string> parameters;
  std::vector<SpreadSeries> series;  ///< one or two
};

/// Ratios in which 95 of 100 such studies end if the covariance is right: sqrt(chi^2 / n).
/// @param freedom  n, positive
/// @param tail     share of the studies that end below it, and above it
[[nodiscard]] std::pair<double, double> spread_interval(int freedom, double tail = 0.025);

/// A row for each parameter, with a dot for each series, one, and spread_interval() of the first.
[[nodiscard]] Chart spread_chart(const SpreadRatios& ratios);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/charts/spread.ipp"
#endif
