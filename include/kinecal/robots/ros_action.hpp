// ROS 1 and ROS 2 actions over a bridge: sends a goal, waits for acceptance and for the end.
//
// ROS 1: topics <action>/goal, /status, /result, /cancel.
// ROS 2: services <action>/_action/send_goal, /get_result.  They are hidden; start the bridge with
// include_hidden:=true.
// Source: ROS 1 wiki, actionlib/DetailedDescription; ROS 2 design, Actions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "kinecal/capture/view.hpp"
#include "kinecal/robots/bridge_client.hpp"

namespace kinecal::detail {

/// The type of an action.
struct ActionKind {
  std::string type;             ///< "control_msgs/FollowJointTrajectory"
  std::string goal_definition;  ///< text of its goal in ROS 1
};

/// An action of the robot.
class RosAction {
 public:
  /// Waits until the bridge offers it.
  /// @param bridge  must outlive this
  /// @param name    "/arm_controller/follow_joint_trajectory"
  /// @throws ConnectionError  if the bridge does not offer it, or it has another type
  RosAction(BridgeClient& bridge, std::string name, ActionKind kind);

  /// Sends a goal and waits until the robot accepts it.
  /// @param goal  fields of the goal
  /// @param now   of the robot's clock
  /// @throws PoseError  if the robot rejects it or does not answer
  void start(const MessageFields& goal, Stamp now);

  /// Waits for the last goal to succeed.
  /// @return  false if it has not ended in time
  /// @throws PoseError  if it ended in another way, with the reason
  [[nodiscard]] bool succeeded(Deadline deadline);

  /// True between start() and the end that succeeded() reports.
  [[nodiscard]] bool is_running() const { return running_; }

 private:
  void start_by_topics(const MessageFields& goal, Stamp now);
  void start_by_services(const MessageFields& goal);
  [[nodiscard]] bool is_acknowledged(Deadline deadline);
  [[nodiscard]] bool take_results(Deadline deadline);
  void end(int status, bool success, const MessageFields& result, std::string_view text);

  BridgeClient* bridge_;
  std::string name_;
  ActionKind kind_;
  bool by_services_ = false, running_ = false, ended_ = false;
  std::string failure_;                       ///< of the goal that has ended
  std::string goal_;                          ///< its id, in ROS 1
  std::array<std::uint8_t, 16> goal_id_{};    ///< in ROS 2
  std::optional<std::uint32_t> result_call_;  ///< in ROS 2
};

}  // namespace kinecal::detail
