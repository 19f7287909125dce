// Expected accuracy over the number of poses: for planning, before anything is measured.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// The accuracy with some number of poses.
struct PoseAccuracy {
  int poses = 0;
  double position = 0.0;  ///< expected standard deviation, metres; infinite: not determined
};

/// Accuracy by number of poses.
struct PoseCurve {
  std::vector<PoseAccuracy> selected;  ///< the best set of poses, by their number
  std::vector<PoseAccuracy> random;    ///< median of random sets, by their number
  double wanted = 0.0;                 ///< requested accuracy, metres
  std::optional<int> knee;             ///< poses beyond which more improve it little, if any
  /// The smallest set that gives the requested accuracy; nullopt: not reached.
  std::optional<PoseAccuracy> enough;
  /// Error that calibrations leave even without noise, metres; zero: negligible.
  double remaining = 0.0;
  int have = 0;  ///< existing poses: then numbers count additional ones, from zero
};

/// Position error over the number of poses, logarithmic, with the requested accuracy and the knee.
[[nodiscard]] Chart pose_curve_chart(const PoseCurve& curve);

}  // namespace kinecal
