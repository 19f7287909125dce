// What is known of the robots of a tree: a line each, JSON, and a page with their drift.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/json/json_text.hpp"
#include "kinecal/tools/watch/fleet.hpp"

namespace kinecal::cli {

inline constexpr double kDay = 86'400.0;  ///< seconds

/// A robot after a look at its recordings.
struct SeenRobot {
  std::string name;        ///< in the tree
  std::string fault;       ///< why it cannot be checked; empty: it can
  RobotHistory history;    ///< with the result in force
  RobotFinding finding;    ///< points into `history`
  RobotDecision decision;  ///< what is to be done
  std::string what;        ///< the pose that matters: "'tool' in 'tracker_frame'"; empty: not known
  double limit = 0.0;      ///< of its change, metres
  std::string mover;       ///< "joint 'elbow'": what drifts or has moved; empty: nothing alone
  std::string moved;       ///< what explains the last recording, where something else may drift
  int written = 0;         ///< recordings that are still being written
};

/// The day, UTC: "2026-11-30".
/// @param time  seconds since 1970
[[nodiscard]] std::string day_text(double time);

/// "arm_3: recalibrate: ..."
[[nodiscard]] std::string line_of(const SeenRobot& robot);

/// "47 of 50 robots hold; recalibrate arm_3; not known: arm_4; cannot be checked: arm_5, arm_6".
[[nodiscard]] std::string summary_of(const std::vector<SeenRobot>& robots);

/// All of it for dashboards.
[[nodiscard]] detail::Json watch_json(const std::vector<SeenRobot>& robots);

/// A page: the robots as a table, and a chart of each.
[[nodiscard]] std::string watch_page(const std::string& tree, const std::vector<SeenRobot>& robots);

}  // namespace kinecal::cli
