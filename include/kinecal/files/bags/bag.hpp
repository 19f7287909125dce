// A bag: messages of several topics in one file, as ROS records them.
//
// Each format has a function of this form; messages come in the order of the file:
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

/// "sensor_msgs/msg/JointState" of ROS 2 is "sensor_msgs/JointState" of ROS 1.
[[nodiscard]] std::string plain_type(std::string_view type);

/// "/joint_states" is "joint_states".
[[nodiscard]] std::string plain_topic(std::string_view name);

/// "sensor_msgs/JointState" is "sensor_msgs/msg/JointState".
[[nodiscard]] std::string ros2_type(std::string_view type);

}  // namespace detail

/// How messages are written as bytes.
enum class Encoding { ros1, cdr };

/// What a bag says about a topic; two connections of one name may differ.
struct BagTopic {
  std::string name;  ///< without a leading slash
  std::string type;  ///< "sensor_msgs/JointState", also for ROS 2's "sensor_msgs/msg/JointState"
  std::string definition = {};  ///< the .msg text with those that it needs; empty if not in the bag
  Encoding encoding = Encoding::ros1;  ///< of its messages
  std::string md5 = {};                ///< of the definition, in ROS 1; empty if not in the bag
};

/// A message of a bag.
struct BagMessage {
  const BagTopic& topic;  ///< valid while it is being handled
  std::int64_t time = 0;  ///< of recording, nanoseconds
  Bytes data;             ///< valid while it is being handled
};

/// What is done with a bag while it is read.
struct BagReader {
  /// Asked once for each topic, before its messages.  Messages of other topics are skipped, unread
  /// where the format allows.
  std::function<bool(const BagTopic&)> wants;
  /// Takes each wanted message.
  std::function<void(const BagMessage&)> handle;
  /// Is told the place in the file that is being read; not of SQLite.
  ProgressMeter meter = {};
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/bags/bag.ipp"
#endif
