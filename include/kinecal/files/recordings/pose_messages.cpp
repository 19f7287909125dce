// Definitions of pose_messages.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/pose_messages.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/messages/make.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/message_decoder.ipp"
#include "kinecal/files/recordings/read_bag.hpp"

namespace kinecal {
namespace detail {

[[nodiscard]] inline std::vector<std::string> texts_in(const MessageFields& message,
                                                       std::string_view name) {
  std::vector<std::string> all;
  const MessageValue* value = message.find(name);
  const auto* list = value == nullptr ? nullptr : value->as<MessageValue::List>();
  if (list == nullptr) return all;
  for (const MessageValue& item : *list) {
    if (const auto* text = item.as<std::string_view>()) all.emplace_back(*text);
  }
  return all;
}

[[nodiscard]] inline std::vector<double> numbers_in(const MessageFields& message,
                                                    std::string_view name) {
  std::vector<double> all;
  const MessageValue* value = message.find(name);
  const auto* list = value == nullptr ? nullptr : value->as<MessageValue::List>();
  if (list == nullptr) return all;
  for (const MessageValue& item : *list) {
    item.visit_number([&](auto x) { all.push_back(static_cast<double>(x)); });
  }
  return all;
}

/// @return  nullopt if names and positions differ in number
[[nodiscard]] inline std::optional<CapturePose> pose_of(const MessageFields& message) {
  const MessageValue* joints = message.find("joint_states");  // else it is a JointState
  const auto* state = joints == nullptr ? &message : joints->as<MessageFields>();
  if (state == nullptr) return std::nullopt;
  CapturePose pose{
      texts_in(*state, "name"), numbers_in(*state, "position"), texts_in(message, "features"), {}};
  if (pose.joint_names.size() != pose.positions.size()) return std::nullopt;
  return pose;
}

}  // namespace detail

std::vector<CapturePose> read_bag_poses(const std::string& path, Diagnostics& diagnostics) {
  std::vector<CapturePose> poses;
  detail::MessageDecoder decoder(path, diagnostics);
  int number = 0;
  const auto wants = [](const BagTopic& topic) { return use_of(topic) == TopicUse::poses; };
  const auto handle = [&](const BagMessage& message) {
    const auto content = decoder.decode(message, ++number);
    if (!content) return;
    if (auto pose = detail::pose_of(*content)) {
      pose->source = SourceLocation{path, number}.str();
      poses.push_back(std::move(*pose));
    } else {
      diagnostics.error({path, number}, "names and positions of the joints differ in number");
    }
  };
  read_bag(path, {wants, handle}, diagnostics);
  if (number == 0 && diagnostics.errors.empty()) {
    diagnostics.error({path, 0},
                      "no messages of robot_calibration_msgs/CaptureConfig or "
                      "sensor_msgs/JointState in this bag");
  }
  return poses;
}

void write_poses(BagOutput& to, const std::vector<CapturePose>& poses) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const BagTopic topic{"calibration_joint_states", "robot_calibration_msgs/CaptureConfig"};
  std::int64_t time = 0;
  for (const CapturePose& pose : poses) {
    to.write(topic, time += kSecond,
             detail::fields("joint_states",
                            detail::fields("name", detail::texts(pose.joint_names), "position",
                                           detail::numbers(pose.positions)),
                            "features", detail::texts(pose.features)));
  }
}

}  // namespace kinecal
