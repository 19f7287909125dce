// Joint positions of a recording over time, and when the robot stood still.
//
// Several nodes may publish different joints, on one topic or on several, at different rates.  Each
// list of joints is a separate track; the robot stands still while all of them do.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/session/settling.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/tools/detect/joint_track.hpp"

namespace kinecal {

/// Joints at a moment of a motion, or why they are not known.
struct JointsInMotion {
  MeasuredJoints joints;     ///< with velocities
  std::string refusal = {};  ///< empty if they are known
};

/// The joints of a recording.
class JointTracks {
 public:
  /// No joints.
  /// @param restless  joints that may do anything
  explicit JointTracks(std::set<std::string> restless = {}) : restless_(std::move(restless)) {}

  /// Adds a message of joint states.  Ignores one without positions.
  /// @param topic  of the message
  void add(const std::string& topic, const MeasuredJoints& reading);

  /// Chooses the track of each joint, after all messages were added.  For a joint on two topics,
  /// uses `joint_states`.
  /// @param topics  to use; empty: all
  /// @param file    name of the recording in messages
  /// @param diagnostics  receives: no positions, a missing topic of `topics`, a joint on two
  ///                     topics, or of two nodes on one, stamps that go back, joints with only a
  ///                     few measurements
  /// @param in_motion    whether views are taken while the robot moves, for messages
  void choose(const std::vector<std::string>& topics, const std::string& file,
              Diagnostics& diagnostics, bool in_motion = false);

  /// All standstills of at least options.window, sorted.
  /// @param restless  joints that need not stand still
  [[nodiscard]] std::vector<Standstill> standstills(const std::set<std::string>& restless = {},
                                                    const SettleOptions& options = {}) const;

  /// Noise of a joint's readings at rest, radians or metres; 0 if it never rests.
  [[nodiscard]] double noise(const std::string& joint) const;

  /// Joints that never stand still, whatever the others do.
  [[nodiscard]] std::vector<std::string> never_still(const SettleOptions& options = {}) const;

  /// All measured joints.
  [[nodiscard]] std::set<std::string> names() const;

  /// Mean positions of all joints near a moment of a standstill: within 150 ms, or 500 ms for noisy
  /// joints.
  [[nodiscard]] MeasuredJoints positions(Stamp stamp, const Standstill& during) const;

  /// Positions and velocities of all joints at a moment, by a parabola through the readings within
  /// 60 ms of it: at least 4, of which the nearest before and after it are within 0.25 s.
  [[nodiscard]] JointsInMotion motion(Stamp stamp) const;

  /// From the first to the last reading; nullopt if absent.
  [[nodiscard]] std::optional<Standstill> span() const;

 private:
  std::set<std::string> restless_;
  [[nodiscard]] bool measures(const std::string& topic, const std::string& joint) const;
  void choose_topics(const std::vector<std::string>& topics, const std::string& file,
                     Diagnostics& diagnostics);
  void settle_conflicts(const std::string& file, Diagnostics& diagnostics);
  void find_second_nodes(const std::string& file, Diagnostics& diagnostics) const;
  std::vector<detail::JointTrack> tracks_;
  /// Messages in which a joint's position is not a number, by topic and joint.
  std::map<std::pair<std::string, std::string>, int> not_finite_;
  std::set<std::string> silent_;  ///< topics with messages, but no positions
};

}  // namespace kinecal
