// Definitions of ros_action.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/robots/ros_action.hpp"

#include <algorithm>
#include <chrono>
#include <random>
#include <span>
#include <string>
#include <utility>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/messages/message_fields.hpp"
#include "kinecal/robots/action_definitions.ipp"
#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

/// From actionlib_msgs/GoalStatus.
inline constexpr int kRos1Succeeded = 3, kRos1Rejected = 5;
/// From action_msgs/GoalStatus.
inline constexpr int kRos2Succeeded = 4;

RosAction::RosAction(BridgeClient& bridge, std::string name, ActionKind kind)
    : bridge_(&bridge), name_(std::move(name)), kind_(std::move(kind)) {
  const std::string service = name_ + "/_action/send_goal", result = name_ + "/result";
  if (!bridge.wait_for(result, service, bridge.deadline())) {
    throw ConnectionError("the bridge offers no action '" + name_ + "': neither topic '" + result +
                          "' (ROS 1) nor service '" + service +
                          "' (ROS 2, if the bridge is started with include_hidden:=true)");
  }
  by_services_ = bridge.has_service(service);
  if (by_services_) return;
  bridge.subscribe(name_ + "/status", {"actionlib_msgs/GoalStatusArray"}, 8);
  bridge.subscribe(result, {kind_.type + "ActionResult"}, 8);
  const std::string type = bridge.topic_type(result, bridge.deadline()).value_or("");
  if (type != kind_.type + "ActionResult") {
    throw ConnectionError("topic '" + result + "' has messages of type '" + printable(type) +
                          "'; expected " + kind_.type + "ActionResult");
  }
}

void RosAction::start(const MessageFields& goal, Stamp now) {
  running_ = ended_ = false;
  failure_.clear();
  if (by_services_) {
    start_by_services(goal);
  } else {
    start_by_topics(goal, now);
  }
  running_ = true;
}

void RosAction::start_by_topics(const MessageFields& goal, Stamp now) {
  static thread_local std::mt19937_64 random{std::random_device{}()};
  goal_ = "kinecal-" + std::to_string(random());
  const PublishedType type{kind_.type + "ActionGoal",
                           ros1_goal(kind_.type + "Goal", kind_.goal_definition)};
  const MessageFields message =
      fields("header", fields("stamp", time_fields(now)), "goal_id",
             fields("stamp", time_fields(now), "id", std::string_view(goal_)), "goal", goal);
  // ROS drops messages published before the robot knows the publisher; the robot accepts a known
  // goal only once.
  constexpr std::chrono::milliseconds kAgain{400};
  const Deadline deadline = bridge_->deadline();
  while (std::chrono::steady_clock::now() < deadline) {
    bridge_->publish(name_ + "/goal", type, message);
    if (is_acknowledged(std::min(deadline, std::chrono::steady_clock::now() + kAgain))) {
      if (!failure_.empty()) throw PoseError(failure_);
      return;
    }
  }
  throw PoseError("action '" + name_ + "' did not take the goal; " +
                  bridge_->why_silent(name_ + "/status"));
}

/// True if the robot has answered the goal.
bool RosAction::is_acknowledged(Deadline deadline) {
  while (true) {
    const auto all = bridge_->take(name_ + "/status", deadline);
    for (const BridgeMessage& message : all) {
      const MessageFields status = message.fields();
      for (const MessageValue& item : list_at(status, "status_list")) {
        const auto* one = item.as<MessageFields>();
        if (one == nullptr || text_at(*one, "goal_id.id") != goal_) continue;
        const int code = static_cast<int>(number_at(*one, "status"));
        if (code == kRos1Rejected) end(code, false, *one, text_at(*one, "text"));
        return true;
      }
    }
    if (take_results(std::chrono::steady_clock::now())) return true;
    if (all.empty()) return false;
  }
}

void RosAction::start_by_services(const MessageFields& goal) {
  static thread_local std::mt19937_64 random{std::random_device{}()};
  for (std::uint8_t& byte : goal_id_) byte = static_cast<std::uint8_t>(random());
  const Bytes id = std::as_bytes(std::span(goal_id_));
  // Bridges put the fields of the goal beside its id; the bytes are the same.
  MessageFields request = fields("goal_id", fields("uuid", id), "goal", goal);
  for (const auto& field : goal.fields) request.fields.push_back(field);
  const std::uint32_t call = bridge_->call(name_ + "/_action/send_goal", request);
  const auto answer = bridge_->response(call, bridge_->deadline());
  if (!answer) throw PoseError("action '" + name_ + "' did not answer to the goal");
  if (number_at(answer->fields(), "accepted") == 0.0) {
    throw PoseError("action '" + name_ + "' refused the goal");
  }
  result_call_ =
      bridge_->call(name_ + "/_action/get_result", fields("goal_id", fields("uuid", id)));
}

bool RosAction::succeeded(Deadline deadline) {
  if (!ended_) {
    if (by_services_) {
      const auto answer = bridge_->response(result_call_.value(), deadline);
      if (!answer) return false;
      const MessageFields result = answer->fields();
      const int status = static_cast<int>(number_at(result, "status"));
      end(status, status == kRos2Succeeded, result, {});
    } else if (!take_results(deadline)) {
      return false;
    }
  }
  running_ = false;
  if (!failure_.empty()) throw PoseError(failure_);
  return true;
}

/// True if the goal's result arrives in time (ROS 1).
bool RosAction::take_results(Deadline deadline) {
  while (true) {
    const auto all = bridge_->take(name_ + "/result", deadline);
    for (const BridgeMessage& message : all) {
      const MessageFields result = message.fields();
      if (text_at(result, "status.goal_id.id") != goal_) continue;
      const int status = static_cast<int>(number_at(result, "status.status"));
      end(status, status == kRos1Succeeded, result, text_at(result, "status.text"));
      return true;
    }
    if (all.empty()) return false;
  }
}

void RosAction::end(int status, bool success, const MessageFields& result, std::string_view text) {
  ended_ = true;
  if (success) return;
  std::string why(text);
  for (const char* const path : {"error_string", "result.error_string"}) {
    const std::string_view more = text_at(result, path);
    if (!more.empty() && why.find(more) == std::string::npos) {
      why += (why.empty() ? "" : "; ") + std::string(more);
    }
  }
  const double code = number_at(result, by_services_ ? "error_code" : "result.error_code");
  failure_ = "action '" + name_ + "' did not succeed: ";
  failure_ += why.empty() ? "status " + std::to_string(status) : printable(why);
  if (code != 0.0) failure_ += " (error " + std::to_string(static_cast<int>(code)) + ")";
}

}  // namespace kinecal::detail
