// The content of a bag: its topics with their types, numbers of messages and use for kinecal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Uses of a topic in kinecal.
enum class TopicUse { none, samples, poses, urdf };

/// The use of a topic in kinecal, by its type.
[[nodiscard]] TopicUse use_of(const BagTopic& topic);

/// The use of a topic as text.
[[nodiscard]] std::string_view to_string(TopicUse use);

/// A topic of a bag and its size.
struct TopicContent {
  std::string name;               ///< without a leading slash
  std::string type;               ///< "sensor_msgs/JointState"
  TopicUse use = TopicUse::none;  ///< in kinecal
  std::int64_t messages = 0;      ///< number of them
  std::uint64_t bytes = 0;        ///< of all messages
};

/// All topics of a bag, sorted by name.
/// @param diagnostics  receives errors in the bag
[[nodiscard]] std::vector<TopicContent> bag_topics(const std::string& path,
                                                   Diagnostics& diagnostics);

/// Of topics that could serve, the one with the first of some usual names, else the first; the others are noted.
/// @param of  what they are, for notes: "sensor_msgs/Imu"
/// @returns   empty: there are none
[[nodiscard]] std::string chosen_topic(std::vector<std::string> names,
                                       const std::vector<std::string>& usual, const std::string& of,
                                       const std::string& path, Diagnostics& diagnostics);

}  // namespace kinecal
