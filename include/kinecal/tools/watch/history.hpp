// What was found in the recordings of robots over months: one SQLite file for a tree of robots.
//
//   robot      its name in the tree, and the checksum of its structure: links and joints, not where they are
//   epoch      a result that was in force: the checksum of its files
//   recording  the verdict on a recording, once per content; or why it was refused
//   change     how far each joint, frame or sensor may have moved in it
//   seen       files that were looked at: size and time; those that were refused are looked at again after each start, as a
//              missing mesh may be there now
//
// A new result of a robot begins an epoch: what is older counts no more.  Recordings are added in transactions, so a full
// disk, a crash or a second watcher leaves whole recordings or none.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace kinecal {

/// How far a joint, frame or sensor has moved in a recording, if it alone has moved.
struct WatchedChange {
  std::string owner = {};                    ///< "elbow_flex_joint"
  bool is_frame = false;                     ///< its frame, not the offset of the joint
  std::vector<std::string> parameters = {};  ///< (k) names
  std::vector<std::string> units = {};       ///< (k)
  std::vector<double> change = {};           ///< (k) since the calibration, in these units
  std::vector<double> covariance = {};       ///< (k x k) row after row
  double score = 0.0;                        ///< see Mover
  bool explains = false;                     ///< what is left is within chance

  /// True if both are of the same parameters.
  [[nodiscard]] bool is_of(const WatchedChange& other) const {
    return owner == other.owner && is_frame == other.is_frame && parameters == other.parameters;
  }
};

/// What became of a recording.
enum class RecordingState { holds, does_not_hold, refused };

/// A recording that was looked at.
struct WatchedRecording {
  std::string name = {};                           ///< its path below the recordings of its robot
  std::string checksum = {};                       ///< SHA-256 of its content
  std::int64_t size = 0;                           ///< bytes
  std::int64_t modified = 0;                       ///< when the file was last written, nanoseconds
  double time = 0.0;                               ///< when it was recorded, seconds since 1970
  RecordingState state = RecordingState::refused;  ///< what became of it
  std::string reason = {};                         ///< why it was refused
  bool may_pass = false;                    ///< by itself, as a lack of memory: it is not `seen`
  int samples = 0;                          ///< number of them
  double statistic = 0.0;                   ///< X, see Drift
  double freedom = 0.0;                     ///< its degrees of freedom
  double probability = 1.0;                 ///< of a larger one by chance
  std::vector<WatchedChange> changes = {};  ///< of all movers
};

namespace detail {
class HistoryFile;
}  // namespace detail

/// The history of a tree of robots.
class History {
 public:
  /// Opens the file; creates it if it is missing.
  /// @param wait  for another watcher that writes to it, seconds
  /// @throws InputError  if it is something else, of a newer version, or cannot be written; if kinecal was built without
  ///                     SQLite
  explicit History(const std::string& file, double wait = 10.0);
  History(const History&) = delete;
  History& operator=(const History&) = delete;
  ~History();

  /// The epoch of a robot's result; begins one if it is new.
  /// @param structure  checksum of its links and joints
  /// @param result     checksum of its result
  /// @returns  its number in the file
  /// @throws InputError  if the robot of this name has another structure: it is another robot
  [[nodiscard]] std::int64_t epoch(const std::string& robot, const std::string& structure,
                                   const std::string& result);
  /// True if an earlier result of the robot of an epoch is known.
  [[nodiscard]] bool follows_another(std::int64_t epoch) const;

  /// True if a file of this name, size and time was looked at, of the robot of an epoch.  What was refused in this epoch counts only
  /// if this object has it.
  [[nodiscard]] bool knows(std::int64_t epoch, const WatchedRecording& file) const;

  /// A recording of a robot.
  struct Place {
    std::string robot;  ///< name of the robot
    std::string name;   ///< of the recording
  };
  /// The one, of any robot, that has this content and was not refused.
  [[nodiscard]] std::optional<Place> with_content(const std::string& checksum) const;

  /// Adds recordings: all, or none with an error.  Of a content that the robot has already, only the file is remembered; a
  /// file that was refused and has changed replaces the one that was refused.
  /// @throws InputError  if the disk is full, or another watcher writes to the file for too long
  void add(std::int64_t epoch, std::span<const WatchedRecording> recordings);

  /// The recordings of an epoch, by time.
  [[nodiscard]] std::vector<WatchedRecording> recordings(std::int64_t epoch) const;

 private:
  std::unique_ptr<detail::HistoryFile> file_;
};

}  // namespace kinecal
