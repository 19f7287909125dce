// How accuracy grows with the number of poses: of a plan, before anything is measured.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// What a number of poses gives.
struct PoseAccuracy {
  int poses = 0;
  double position = 0.0;  ///< expected standard deviation, metres; infinite: not determined
};

/// Accuracy by number of poses.
struct PoseCurve {
  std::vector<PoseAccuracy> selected;  ///< the poses that are best together, by their number
  std::vector<PoseAccuracy> random;    ///< median of random sets, by their number
  double wanted = 0.0;                 ///< accuracy that is asked for, metres
  std::optional<int> knee;  ///< poses after which more improve it little; none within the curve
  /// The least set that gives what is asked for; none: not reached.
  std::optional<PoseAccuracy> enough;
  /// Error that calibrations leave without noise, metres; zero: too little to say so.
  double remaining = 0.0;
  int have = 0;  ///< poses that exist: numbers are of those in addition, and begin at zero
};

/// Position over number of poses, logarithmic, with what is asked for and the knee.
[[nodiscard]] Chart pose_curve_chart(const PoseCurve& curve);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/charts/pose_curve.ipp"
#endif
