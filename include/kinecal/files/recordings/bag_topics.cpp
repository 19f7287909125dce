// Definitions of bag_topics.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/bag_topics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/recordings/read_bag.hpp"

namespace kinecal {

TopicUse use_of(const BagTopic& topic) {
  if (topic.type == "robot_calibration_msgs/CalibrationData") return TopicUse::samples;
  if (topic.type == "robot_calibration_msgs/CaptureConfig") return TopicUse::poses;
  if (topic.type == "sensor_msgs/JointState") return TopicUse::poses;
  const bool is_urdf = topic.type == "std_msgs/String" && topic.name.ends_with("robot_description");
  return is_urdf ? TopicUse::urdf : TopicUse::none;
}

std::string_view to_string(TopicUse use) {
  switch (use) {
    case TopicUse::samples:
      return "samples";
    case TopicUse::poses:
      return "poses to capture";
    case TopicUse::urdf:
      return "URDF";
    case TopicUse::none:
      break;
  }
  return "-";
}

std::vector<TopicContent> bag_topics(const std::string& path, Diagnostics& diagnostics) {
  std::map<std::pair<std::string, std::string>, TopicContent> topics;
  const auto content = [&](const BagTopic& topic) -> TopicContent& {
    return topics
        .try_emplace({topic.name, topic.type}, TopicContent{topic.name, topic.type, use_of(topic)})
        .first->second;
  };
  const auto wants = [&](const BagTopic& topic) {
    (void)content(topic);  // also a topic without messages
    return true;
  };
  const auto handle = [&](const BagMessage& message) {
    TopicContent& topic = content(message.topic);
    ++topic.messages;
    topic.bytes += message.data.size();
  };
  read_bag(path, {wants, handle}, diagnostics);
  std::vector<TopicContent> all;
  for (auto& [key, topic] : topics) all.push_back(std::move(topic));
  return all;
}

std::string chosen_topic(std::vector<std::string> names, const std::vector<std::string>& usual,
                         const std::string& of, const std::string& path, Diagnostics& diagnostics) {
  if (names.empty()) return "";
  std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    const auto rank = [&](const std::string& name) {
      return std::find(usual.begin(), usual.end(), name) - usual.begin();
    };
    return rank(a) < rank(b);
  });
  for (std::size_t i = 1; i < names.size(); ++i) {
    diagnostics.note({path, 0}, fmt::format("of the topics of {}, '{}' is used, not '{}'", of,
                                            names.front(), names[i]));
  }
  return names.front();
}

}  // namespace kinecal
