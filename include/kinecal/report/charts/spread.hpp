// Compares the scatter of calibrations with the covariance's prediction, for a study.
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
  int freedom = 0;             ///< degrees of freedom: calibrations minus means
  std::vector<double> ratios;  ///< of each parameter, see SpreadRatios; NaN: not determined
};

/// Standard deviation of calibrations over the one that the covariance predicts.
struct SpreadRatios {
  std::vector<std::string> parameters;
  std::vector<SpreadSeries> series;  ///< one or two
};

/// Range of ratios of 95 % of such studies if the covariance is right: sqrt(chi^2 / n).
/// @param freedom  n, positive
/// @param tail     fraction of the studies below it, and above it
[[nodiscard]] std::pair<double, double> spread_interval(int freedom, double tail = 0.025);

/// A row for each parameter, with a dot for each series, a line at one, and spread_interval() of
/// the first.
[[nodiscard]] Chart spread_chart(const SpreadRatios& ratios);

}  // namespace kinecal
