// What is in a bag: its topics, their types, how many messages and what kinecal can use.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/io/recordings/known_topics.hpp"
#include "kinecal/io/recordings/read_bag.hpp"

namespace kinecal {

struct TopicContent {
  std::string name, type;
  TopicUse use = TopicUse::none;
  std::int64_t messages = 0;
  std::uint64_t bytes = 0;  ///< of the messages
};

/// What kinecal can use a topic for, in words.
[[nodiscard]] inline std::string_view to_string(TopicUse use) {
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

/// All topics of a bag, by name.
[[nodiscard]] inline std::vector<TopicContent> bag_topics(const std::string& path,
                                                          Diagnostics& diagnostics) {
  std::map<std::pair<std::string, std::string>, TopicContent> topics;
  const auto content = [&](const BagTopic& topic) -> TopicContent& {
    return topics
        .try_emplace({topic.name, topic.type}, TopicContent{topic.name, topic.type, use_of(topic)})
        .first->second;
  };
  const auto wants = [&](const BagTopic& topic) {
    (void)content(topic);  // also one without messages
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

}  // namespace kinecal
