// What recordings of a robot say over weeks: a change with its deviation, and the line through it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal {

/// A recording in the chart.
struct DriftPoint {
  double time = 0.0;       ///< seconds since 1970
  double value = 0.0;      ///< in the unit of the chart
  double deviation = 0.0;  ///< its standard deviation; 0: not drawn
  bool holds = true;       ///< the result holds for it
};

/// The recordings of a robot.
struct DriftSeries {
  std::string name;                ///< of the chart: unique on its page
  std::string title;               ///< "arm_3: joint 'elbow'"
  std::string caption;             ///< may be empty
  std::string what;                ///< what the values are: "change since the calibration"
  std::string unit;                ///< "rad", "m", or "" for a ratio
  double expected = 0.0;           ///< drawn as a level: 0 of a change, 1 of a ratio
  std::vector<DriftPoint> points;  ///< by time
  /// Slope, in the unit by seconds, through `level` at `origin`; nullopt: no line.
  struct Line {
    double origin = 0.0;  ///< seconds since 1970
    double level = 0.0;   ///< there
    double slope = 0.0;   ///< a second
  };
  std::optional<Line> line = {};  ///< the drift
};

/// Draws it; weeks from the first recording.
[[nodiscard]] Chart drift_chart(const DriftSeries& series);

}  // namespace kinecal
