// The joint states of a robot behind a bridge.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/files/messages/message_fields.ipp"
#include "kinecal/robots/bridge_client.hpp"

namespace kinecal::detail {

/// Offset of this computer's clock ahead of a stream's stamps.
using ClockOffset = std::chrono::nanoseconds;

[[nodiscard]] inline ClockOffset clock_offset(const BridgeMessage& message, Stamp stamp) {
  return std::chrono::duration_cast<ClockOffset>(message.arrival.time_since_epoch()) - stamp;
}

/// A connection and the state of the joints.  Several nodes may publish different joints on one
/// topic, so the newest position of each joint is kept.
class RosRobot {
 public:
  RosRobot(const BridgeOptions& options, std::string topic)
      : bridge(options), topic_(std::move(topic)) {
    constexpr std::size_t kKept = 256;
    bridge.subscribe(topic_, {"sensor_msgs/JointState"}, kKept);
  }

  BridgeClient bridge;

  /// Positions of all joints.
  /// @param needed  joints whose stamps must be later; empty: any
  /// @throws SilenceError     if they do not arrive in time
  /// @throws ConnectionError  if the bridge has withdrawn their topic
  [[nodiscard]] MeasuredJoints next(Stamp after, const std::vector<std::string>& needed) {
    const Deadline deadline = bridge.deadline();
    take(std::chrono::steady_clock::now());
    while (true) {
      const auto stamp = stamp_of(needed);
      if (stamp && *stamp > after) return joints(*stamp);
      if (!take(deadline)) fail_late(after, needed);
    }
  }

  /// The newest stamp; nullopt before the first message.
  [[nodiscard]] std::optional<Stamp> newest() const { return newest_; }

  /// Offset of this computer's clock ahead of the robot's; nullopt before the first message.
  [[nodiscard]] std::optional<ClockOffset> offset() {
    take(std::chrono::steady_clock::now());
    return offset_;
  }

  /// Stamp of the next joint states.
  [[nodiscard]] Stamp now() {
    take(std::chrono::steady_clock::now());
    if (!take(bridge.deadline())) fail_late(newest_.value_or(Stamp{}), {});
    return newest_.value();
  }

  /// Reports a silent topic.
  /// @param newest  stamp of its last message
  [[noreturn]] void fail_silent(const std::string& topic, const std::string& why,
                                std::optional<Stamp> newest) {
    if (newest && !bridge.topic_type(topic, std::chrono::steady_clock::now())) {
      throw ConnectionError("topic '" + topic +
                            "': the bridge has withdrawn it; its newest message is of " +
                            stamp_text(*newest));
    }
    throw SilenceError(why, topic, newest);
  }

 private:
  struct Position {
    double value;
    Stamp stamp;
  };

  /// False if nothing came in time.
  bool take(Deadline deadline) {
    const auto messages = bridge.take(topic_, deadline);
    for (const BridgeMessage& message : messages) {
      const MessageFields state = message.fields();
      const Stamp stamp = header_stamp(state);
      // A restarted simulation or recording has earlier stamps.
      constexpr std::chrono::seconds kRestart{1};
      if (newest_ && stamp < *newest_ - kRestart) positions_.clear();
      if (!newest_ || stamp > *newest_ || positions_.empty()) newest_ = stamp;
      offset_ = clock_offset(message, stamp);
      const auto& names = list_at(state, "name");
      const auto& values = list_at(state, "position");
      for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) {
        const auto* name = names[i].as<std::string_view>();
        const auto* value = values[i].as<double>();
        if (name != nullptr && value != nullptr) positions_[std::string(*name)] = {*value, stamp};
      }
    }
    return !messages.empty();
  }

  /// The oldest stamp of these joints; nullopt if one is unknown.
  [[nodiscard]] std::optional<Stamp> stamp_of(const std::vector<std::string>& needed) const {
    std::optional<Stamp> oldest = newest_;
    for (const std::string& joint : needed) {
      const auto position = positions_.find(joint);
      if (position == positions_.end()) return std::nullopt;
      oldest = std::min(*oldest, position->second.stamp);
    }
    return oldest;
  }

  [[nodiscard]] MeasuredJoints joints(Stamp stamp) const {
    MeasuredJoints joints;
    joints.stamp = stamp;
    for (const auto& [name, position] : positions_) {
      joints.names.push_back(name);
      joints.positions.push_back(position.value);
    }
    return joints;
  }

  [[noreturn]] void fail_late(Stamp after, const std::vector<std::string>& needed) {
    if (!newest_) throw SilenceError(bridge.why_silent(topic_), topic_, {});
    const std::string who = "topic '" + topic_ + "'";
    for (const std::string& joint : needed) {
      const auto position = positions_.find(joint);
      const std::string stream = topic_ + ": " + joint;
      if (position == positions_.end()) {
        throw SilenceError(who + " has no positions of joint '" + joint + "'", stream, {});
      }
      const Stamp last = position->second.stamp;
      if (last > after || *newest_ <= after) continue;
      throw SilenceError(
          who + ": joint '" + joint + "' is not measured any more, since " + stamp_text(last),
          stream, last);
    }
    fail_silent(topic_,
                who + ": no joint positions after " + stamp_text(after) + "; the newest are of " +
                    stamp_text(*newest_),
                newest_);
  }

  std::string topic_;
  std::map<std::string, Position> positions_;
  std::optional<Stamp> newest_;
  std::optional<ClockOffset> offset_;
};

}  // namespace kinecal::detail
