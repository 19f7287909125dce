// Definitions of action messages: in ROS 1 the client publishes them, in ROS 2 older bridges omit
// them.
// Source: packages actionlib_msgs, control_msgs, trajectory_msgs, robot_calibration_msgs; ROS 2
// design, Actions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kinecal::detail {

inline constexpr std::string_view kGoalId = "time stamp\nstring id\n";

inline constexpr std::string_view kJointTrajectory =
    "===\nMSG: trajectory_msgs/JointTrajectory\n"
    "std_msgs/Header header\n"
    "string[] joint_names\n"
    "JointTrajectoryPoint[] points\n"
    "===\nMSG: control_msgs/JointTolerance\n"
    "string name\n"
    "float64 position\n"
    "float64 velocity\n"
    "float64 acceleration\n";

/// The published goal of a ROS 1 action.
/// @param type  of the goal: "control_msgs/FollowJointTrajectoryGoal"
/// @param goal  text of that definition
[[nodiscard]] inline std::string ros1_goal(const std::string& type, std::string_view goal) {
  return "std_msgs/Header header\nactionlib_msgs/GoalID goal_id\n" + type +
         " goal\n"
         "===\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
         "===\nMSG: actionlib_msgs/GoalID\n" +
         std::string(kGoalId) + "===\nMSG: " + type + "\n" + std::string(goal);
}

/// The goal of FollowJointTrajectory in ROS 1.
[[nodiscard]] inline std::string ros1_trajectory() {
  return "trajectory_msgs/JointTrajectory trajectory\n"
         "JointTolerance[] path_tolerance\n"
         "JointTolerance[] goal_tolerance\n"
         "duration goal_time_tolerance\n" +
         std::string(kJointTrajectory) +
         "===\nMSG: trajectory_msgs/JointTrajectoryPoint\n"
         "float64[] positions\n"
         "float64[] velocities\n"
         "float64[] accelerations\n"
         "float64[] effort\n"
         "duration time_from_start\n";
}

/// The goal of FollowJointTrajectory since ROS 2 Galactic.
[[nodiscard]] inline std::string ros2_trajectory() {
  return "trajectory_msgs/JointTrajectory trajectory\n"
         "trajectory_msgs/MultiDOFJointTrajectory multi_dof_trajectory\n"
         "JointTolerance[] path_tolerance\n"
         "JointComponentTolerance[] component_path_tolerance\n"
         "JointTolerance[] goal_tolerance\n"
         "JointComponentTolerance[] component_goal_tolerance\n"
         "builtin_interfaces/Duration goal_time_tolerance\n" +
         std::string(kJointTrajectory) +
         "===\nMSG: trajectory_msgs/JointTrajectoryPoint\n"
         "float64[] positions\n"
         "float64[] velocities\n"
         "float64[] accelerations\n"
         "float64[] effort\n"
         "builtin_interfaces/Duration time_from_start\n"
         "===\nMSG: trajectory_msgs/MultiDOFJointTrajectory\n"
         "std_msgs/Header header\n"
         "string[] joint_names\n"
         "uint8[] points\n"  // always empty, and an empty list has the same bytes for all types
         "===\nMSG: control_msgs/JointComponentTolerance\n"
         "std_msgs/Header joint_name\n";
}

/// Definitions of the services of ROS 2 actions that kinecal calls; empty for other types.  Goals
/// and results are written without an enclosing message, which has the same bytes.
/// @param type  "control_msgs/FollowJointTrajectory_SendGoal_Request"
[[nodiscard]] inline std::string action_definition(const std::string& type) {
  const std::string uuid = "unique_identifier_msgs/UUID goal_id\n";
  const std::string others =
      "===\nMSG: unique_identifier_msgs/UUID\nuint8[16] uuid\n"
      "===\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
  if (type.ends_with("_SendGoal_Response")) return "bool accepted\nbuiltin_interfaces/Time stamp\n";
  if (type.ends_with("_GetResult_Request")) return uuid + others;
  if (type == "control_msgs/FollowJointTrajectory_SendGoal_Request") {
    return uuid + ros2_trajectory() + others;
  }
  if (type == "robot_calibration_msgs/GripperLedCommand_SendGoal_Request") {
    return uuid + "uint8 led_code\n" + others;
  }
  if (type == "control_msgs/FollowJointTrajectory_GetResult_Response") {
    return "int8 status\nint32 error_code\nstring error_string\n";
  }
  return type.ends_with("_GetResult_Response") ? "int8 status\n" : "";
}

}  // namespace kinecal::detail
