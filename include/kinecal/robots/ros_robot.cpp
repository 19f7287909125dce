// Definitions of ros_robot.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/ros_robot.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/messages/make.ipp"
#include "kinecal/robots/action_definitions.ipp"
#include "kinecal/robots/joint_stream.ipp"
#include "kinecal/robots/ros_action.hpp"
#include "kinecal/robots/view_streams.ipp"

namespace kinecal {

RosBridge::RosBridge(const BridgeOptions& options, const std::string& joint_states)
    : robot_(std::make_unique<detail::RosRobot>(options, joint_states)) {}
RosBridge::RosBridge(RosBridge&&) noexcept = default;
RosBridge& RosBridge::operator=(RosBridge&&) noexcept = default;
RosBridge::~RosBridge() = default;

namespace detail {
namespace {

/// Duration for the joint with the longest path, seconds.
[[nodiscard]] double motion_time(const JointTarget& target, const MeasuredJoints& now,
                                 const RosArmOptions& options) {
  double time = options.duration;
  for (std::size_t i = 0; i < target.names.size(); ++i) {
    const auto from = now.position(target.names[i]);
    if (!from) continue;
    const auto own = options.speeds.find(target.names[i]);
    const double speed = own == options.speeds.end() ? options.speed : own->second;
    time = std::max(time, std::abs(target.positions[i] - *from) / (speed * target.velocity_factor));
  }
  return time;
}

/// The goal of FollowJointTrajectory: one point; joints without a target stay.
[[nodiscard]] MessageFields trajectory_goal(const JointController& controller,
                                            const MeasuredJoints& target, double time) {
  std::vector<double> positions;
  for (const std::string& joint : controller.joints) {
    positions.push_back(target.position(joint).value());
  }
  const std::vector<double> zeros(positions.size(), 0.0);
  const auto duration = std::chrono::duration_cast<Stamp>(std::chrono::duration<double>(time));
  MessageValue::List points;
  points.push_back(MessageValue(fields("positions", numbers(positions), "velocities",
                                       numbers(zeros), "time_from_start", time_fields(duration))));
  return fields("trajectory", fields("joint_names", texts(controller.joints), "points", points));
}

}  // namespace
}  // namespace detail

RosArm::RosArm(RosBridge& bridge, const RosArmOptions& options)
    : robot_(&bridge.robot()), options_(options) {
  for (const JointController& controller : options_.controllers) {
    actions_.emplace_back(
        robot_->bridge, controller.action,
        detail::ActionKind{"control_msgs/FollowJointTrajectory", detail::ros1_trajectory()});
  }
}
RosArm::RosArm(RosArm&&) noexcept = default;
RosArm& RosArm::operator=(RosArm&&) noexcept = default;
RosArm::~RosArm() = default;

void RosArm::move(const JointTarget& target) {
  if (target.names.size() != target.positions.size()) {
    throw std::invalid_argument("a target has " + std::to_string(target.names.size()) +
                                " joints and " + std::to_string(target.positions.size()) +
                                " positions");
  }
  if (!(target.velocity_factor > 0.0 && target.velocity_factor <= 1.0)) {
    throw std::invalid_argument("velocity factor must be in (0, 1], is " +
                                std::to_string(target.velocity_factor));
  }
  const MeasuredJoints now = next_joints(Stamp::min());
  const MeasuredJoints wanted{now.stamp, target.names, target.positions};
  bool moves = false;
  for (std::size_t i = 0; i < actions_.size(); ++i) {
    const JointController& controller = options_.controllers[i];
    MeasuredJoints all{now.stamp, controller.joints, {}};
    JointTarget own{{}, {}, target.velocity_factor};
    for (const std::string& joint : controller.joints) {
      const auto position = wanted.position(joint);
      all.positions.push_back(position ? *position : now.position(joint).value());
      if (!position) continue;
      own.names.push_back(joint);
      own.positions.push_back(*position);
    }
    if (own.names.empty()) continue;
    moves = true;
    actions_[i].start(
        detail::trajectory_goal(controller, all, detail::motion_time(own, now, options_)),
        now.stamp);
  }
  if (!moves) throw PoseError("no controller moves any of the joints of this pose");
}

MeasuredJoints RosArm::next_joints(Stamp after) {
  for (detail::RosAction& action : actions_) {
    if (action.is_running()) (void)action.succeeded(std::chrono::steady_clock::now());
  }
  std::vector<std::string> needed = options_.measured;
  for (const JointController& controller : options_.controllers) {
    needed.insert(needed.end(), controller.joints.begin(), controller.joints.end());
  }
  return robot_->next(after, needed);
}

RosCamera::RosCamera(RosBridge& bridge, const RosCameraOptions& options)
    : streams_(std::make_unique<detail::ViewStreams>(bridge.robot(), options)) {}
RosCamera::RosCamera(RosCamera&&) noexcept = default;
RosCamera& RosCamera::operator=(RosCamera&&) noexcept = default;
RosCamera::~RosCamera() = default;

View RosCamera::next_view(Stamp after) {
  return streams_->next(after);
}

RosLamp::RosLamp(RosBridge& bridge, const std::string& action)
    : robot_(&bridge.robot()),
      action_(std::make_unique<detail::RosAction>(
          robot_->bridge, action,
          detail::ActionKind{"robot_calibration_msgs/GripperLedCommand", "uint8 led_code\n"})) {}
RosLamp::RosLamp(RosLamp&&) noexcept = default;
RosLamp& RosLamp::operator=(RosLamp&&) noexcept = default;
RosLamp::~RosLamp() = default;

Stamp RosLamp::light(int code) {
  constexpr int kMost = 255;
  if (code < 0 || code > kMost) {
    throw std::invalid_argument("an LED code is 0 to 255, is " + std::to_string(code));
  }
  const Stamp now = robot_->newest() ? *robot_->newest() : robot_->now();
  action_->start(detail::fields("led_code", std::uint64_t(code)), now);
  if (!action_->succeeded(robot_->bridge.deadline())) {
    throw PoseError("the LEDs did not switch in time: their action has not ended");
  }
  return robot_->now();
}

}  // namespace kinecal
