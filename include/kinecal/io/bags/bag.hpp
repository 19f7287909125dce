// A bag: messages of several topics in one file, as ROS records them.
//
// Each format has a function of this form; messages come in the order of the file:
//
//   void read_<format>(const std::string& path, const BagReader& reader, Diagnostics& diagnostics);
//
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "kinecal/io/bags/bytes.hpp"

namespace kinecal {

/// "sensor_msgs/msg/JointState" of ROS 2 is "sensor_msgs/JointState" of ROS 1.
[[nodiscard]] inline std::string plain_type(std::string_view type) {
  const std::size_t at = type.find("/msg/");
  if (at == std::string_view::npos) return std::string(type);
  return std::string(type.substr(0, at)) + std::string(type.substr(at + 4));
}

/// "/joint_states" is "joint_states".
[[nodiscard]] inline std::string plain_topic(std::string_view name) {
  name.remove_prefix(std::min(name.find_first_not_of('/'), name.size()));
  return std::string(name);
}

/// How messages are written as bytes.
enum class Encoding { ros1, cdr };

/// What a bag says of a topic; two connections of one name may differ.
struct BagTopic {
  std::string name;  ///< without a leading slash
  std::string
      type;  ///< "sensor_msgs/JointState", also where ROS 2 says "sensor_msgs/msg/JointState"
  std::string definition =
      {};  ///< the .msg text with those that it needs, of ROS; empty if not told
  Encoding encoding = Encoding::ros1;
  std::string md5 = {};  ///< of the definition, of ROS 1; empty if not told
};

struct BagMessage {
  const BagTopic& topic;
  std::int64_t time = 0;  ///< of recording, nanoseconds
  Bytes data;             ///< valid while it is being handled
};

/// What is done with a bag while it is read.
struct BagReader {
  /// Asked once for each topic, before its messages; those of others are skipped, unread where the
  /// format allows.
  std::function<bool(const BagTopic&)> wants;
  std::function<void(const BagMessage&)> handle;
};

}  // namespace kinecal
