// Robots in a tree of folders, their recordings, and which of the robots have to be calibrated again.
//
//   fleet/line_1/arm_3/result/        what 'calibrate --output' wrote: the result in force
//   fleet/line_1/arm_3/recordings/    files of any format that appear there, also in folders
//
// A verdict on one recording is wrong about once in a hundred times; of many robots and nights some always are.  So a
// robot is said to have moved, or to drift, only if that is no chance among all recordings, and all movers of all robots.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/tools/watch/history.hpp"
#include "kinecal/trust/verify/drift_over_time.hpp"

namespace kinecal {

/// The folders of a robot in its own.
struct WatchedFolders {
  std::string result = "result";          ///< what calibrate wrote
  std::string recordings = "recordings";  ///< files that appear
};

/// A robot in a tree of folders.
struct WatchedRobot {
  std::string name;        ///< its path in the tree: "line_1/arm_3"; of the tree itself, its name
  std::string result;      ///< path of that folder
  std::string recordings;  ///< path of that folder
};

/// The robots in a tree, in natural order: folders that have one of these folders.
/// @throws InputError  if the tree cannot be read, or has none
[[nodiscard]] std::vector<WatchedRobot> robots_in(const std::string& tree,
                                                  const WatchedFolders& folders = {});

/// A recording as files.
struct RecordingFiles {
  std::string path;                ///< of the file, or of the folder of a ROS 2 bag
  std::vector<std::string> files;  ///< all of them, in natural order
  WatchedRecording seen;           ///< name, size and when it was last written
  bool is_open = false;            ///< another program has a file beside it that it writes to
  std::int64_t changed = 0;  ///< when anything of it last changed here, also its date, nanoseconds
};

/// The recordings below a folder, in natural order; none if it does not exist.  Hidden files, temporary ones (.part, .tmp,
/// .active, ~) and columns.yaml are no recordings.
[[nodiscard]] std::vector<RecordingFiles> recordings_in(const std::string& folder);

/// True if nothing was written to a recording for some time.  One whose date is ahead of `now` was dated by another clock: of it,
/// `changed` counts.
/// @param now  nanoseconds, as `modified`
[[nodiscard]] bool is_settled(const RecordingFiles& recording, std::int64_t now, double seconds);

/// The time now, and when a file was last written, as WatchedRecording::modified has it: nanoseconds since 1970; 0 if it
/// does not exist.
/// @{
[[nodiscard]] std::int64_t file_time_now();
[[nodiscard]] std::int64_t file_time(const std::string& file);
/// @}

/// Checksum of links and joints: the same after a calibration, another one of another robot.
[[nodiscard]] std::string structure_checksum(const Robot& robot);

/// The recordings of a robot with the result in force, by time.
struct RobotHistory {
  std::string name;                          ///< of the robot
  std::vector<WatchedRecording> recordings;  ///< with this result, by time
};

/// A drift that is no chance.
struct FoundDrift {
  WatchedChange of;                ///< owner and parameters; no numbers
  std::vector<std::string> alike;  ///< other owners that explain the recordings as well
  DriftLine line;                  ///< of the changes of its parameters
  double probability = 1.0;        ///< of such a drift, of anything of any robot, by chance
};

/// What the recordings of a robot say.
struct RobotFinding {
  int usable = 0;                          ///< recordings that were verified
  int refused = 0;                         ///< and that were not
  bool is_last_refused = false;            ///< the newest one is among them
  const WatchedRecording* last = nullptr;  ///< the newest usable one; none: nullptr
  bool has_moved = false;                  ///< it does not hold, and that is no chance
  double probability = 1.0;                ///< of that, in any recording of any robot, by chance
  const WatchedChange* moved = nullptr;    ///< what explains it; nullptr: nothing alone
  std::optional<FoundDrift> drift = {};    ///< nullopt: none, or chance
};

/// Judges all robots together.
/// @param robots  stay where they are: findings point to their recordings
/// @param level   probability of a false alarm about any of them, of moves and drifts each a half
[[nodiscard]] std::vector<RobotFinding> judge_fleet(std::span<const RobotHistory> robots,
                                                    double level = 0.01);

/// What is to be done with a robot.
enum class FleetState { not_known, holds, drifts, recalibrate };

/// When a change matters.
struct WatchLimits {
  /// How the changes of a mover are measured; nullopt, or empty: not known.
  std::function<std::optional<ChangeSize>(const WatchedChange&)> size = {};
  double limit = 0.0;  ///< of a size
  double now = 0.0;    ///< seconds since 1970
  double ahead = 0.0;  ///< seconds within which a drift must not pass the limit
};

/// The state of a robot, and why.
struct RobotDecision {
  FleetState state = FleetState::not_known;  ///< what is to be done
  std::optional<double> change = {};         ///< size of the drift so far, or of what has moved
  std::optional<When> passes = {};           ///< when a drift passes the limit
};

/// Decides.  A robot with a small drift may have moved by more, elsewhere: each is measured by itself, and `change` is the larger one.
/// What has moved by an unknown size matters; a drift of unknown size does not by itself.
[[nodiscard]] RobotDecision decide(const RobotFinding& finding, const WatchLimits& limits);

}  // namespace kinecal
