// Small ROS 1 bags in memory: written, read, and compared.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <ostream>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "kinecal/files/bags/ros1/read_bag.hpp"
#include "kinecal/files/bags/ros1/write_bag.hpp"

namespace kinecal::test {

struct Recorded {
  std::string topic;
  std::int64_t time = 0;
  std::string data;
  bool operator==(const Recorded&) const = default;
};

inline std::ostream& operator<<(std::ostream& out, const Recorded& m) {
  return out << m.topic << " at " << m.time << ", " << m.data.size() << " bytes";
}

struct BagContents {
  std::vector<BagTopic> topics;  ///< the wanted ones
  std::vector<Recorded> messages;
  std::vector<std::string> errors, warnings;
};

inline BagContents read_bag(std::istream& in, const std::set<std::string>& wanted = {}) {
  BagContents read;
  Diagnostics diagnostics;
  const BagReader reader{
      [&](const BagTopic& topic) {
        read.topics.push_back(topic);
        return wanted.empty() || wanted.contains(topic.name);
      },
      [&](const BagMessage& message) {
        const auto* data = reinterpret_cast<const char*>(message.data.data());
        read.messages.push_back({message.topic.name, message.time, {data, message.data.size()}});
      }};
  read_ros1_bag(in, "a.bag", reader, diagnostics);
  read.errors = diagnostics.errors;
  read.warnings = diagnostics.warnings;
  return read;
}

inline BagContents read_bag(const std::string& bag, const std::set<std::string>& wanted = {}) {
  std::istringstream in(bag);
  return read_bag(in, wanted);
}

inline const BagTopic kJoints{"/joint_states", "sensor_msgs/JointState",
                              "float64[] position\n# and so on\n", Encoding::ros1,
                              "3066dcd76a6cfaef579bd0f34173e9fd"};
inline const BagTopic kRobot{"robot_description", "std_msgs/String", "string data\n",
                             Encoding::ros1, "992ce8a1687cec8c8bd883ec73ca41d1"};

inline std::vector<Recorded> some_messages(int count) {
  std::vector<Recorded> messages{{"robot_description", 999'999'999, "<robot name='r'/>"}};
  for (int i = 1; i < count; ++i) {
    messages.push_back({"joint_states", 1'445'000'000'000'000'000 + i * 20'000'001LL,
                        std::string(static_cast<std::size_t>(i % 7), 'a') + std::to_string(i)});
  }
  return messages;
}

/// @param close  false: an interrupted recording
inline std::string bag_of(const std::vector<Recorded>& messages,
                          Compression compression = Compression::none,
                          std::size_t chunk_bytes = 300, bool close = true) {
  std::ostringstream out;
  Ros1BagWriter bag(out, compression, chunk_bytes);
  const std::uint32_t robot = bag.add_topic(kRobot, true), joints = bag.add_topic(kJoints);
  for (const Recorded& m : messages) {
    bag.write(m.topic == "robot_description" ? robot : joints, m.time,
              std::as_bytes(std::span(m.data)));
  }
  if (close) bag.close();
  return out.str();
}

/// The compressions that this build of kinecal reads.
inline std::vector<Compression> compressions_of_ros1() {
  std::vector<Compression> found;
  for (const Compression c : {Compression::none, Compression::bz2, Compression::lz4}) {
    if (is_available(c)) found.push_back(c);
  }
  return found;
}

}  // namespace kinecal::test
