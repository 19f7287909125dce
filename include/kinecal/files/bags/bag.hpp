// A bag: recorded ROS messages of several topics in one file.
//
// Each format has a function of this form; messages come in file order:
//
//   void read_<format>(const std::string& path, const BagReader& reader, Diagnostics& diagnostics);
//
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/samples/progress_meter.hpp"

namespace kinecal {

namespace detail {

/// "sensor_msgs/msg/JointState" of ROS 2 becomes "sensor_msgs/JointState" of ROS 1.
[[nodiscard]] std::string plain_type(std::string_view type);

/// "/joint_states" becomes "joint_states".
[[nodiscard]] std::string plain_topic(std::string_view name);

/// "sensor_msgs/JointState" becomes "sensor_msgs/msg/JointState".
[[nodiscard]] std::string ros2_type(std::string_view type);

}  // namespace detail

/// Encodings of messages.
enum class Encoding { ros1, cdr };

/// A topic of a bag; two connections with the same name may differ.
struct BagTopic {
  std::string name;  ///< without a leading slash
  std::string type;  ///< "sensor_msgs/JointState", also for ROS 2's "sensor_msgs/msg/JointState"
  std::string definition = {};  ///< the .msg text with all types it needs; empty if not in the bag
  Encoding encoding = Encoding::ros1;  ///< of its messages
  std::string md5 = {};                ///< of the definition, in ROS 1; empty if not in the bag
};

/// A message of a bag.
struct BagMessage {
  const BagTopic& topic;  ///< valid during the call
  std::int64_t time = 0;  ///< of recording, nanoseconds
  Bytes data;             ///< valid during the call
};

/// Callbacks for reading a bag.
struct BagReader {
  /// Called once per topic, before its messages.  Skips messages of other topics, unread if the
  /// format allows.
  std::function<bool(const BagTopic&)> wants;
  /// Receives each wanted message.
  std::function<void(const BagMessage&)> handle;
  /// Receives the progress in the file; not for SQLite.
  ProgressMeter meter = {};
};

}  // namespace kinecal
