// The content of a bag as text, for comparison.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

struct BagReading {
  std::vector<std::string> topics;    ///< "name type encoding definition", the wanted ones
  std::vector<std::string> messages;  ///< "name time data"
  std::vector<std::string> errors, warnings;
};

/// @param wanted  names of topics; empty for all
/// @param read    (const BagReader&, Diagnostics&)
template <class Read>
[[nodiscard]] BagReading read_bag(const std::vector<std::string>& wanted, const Read& read) {
  BagReading reading;
  BagReader reader;
  reader.wants = [&](const BagTopic& topic) {
    const char* encoding = topic.encoding == Encoding::cdr ? " cdr " : " ros1 ";
    reading.topics.push_back(topic.name + " " + topic.type + encoding + topic.definition);
    return wanted.empty() || std::count(wanted.begin(), wanted.end(), topic.name) > 0;
  };
  reader.handle = [&](const BagMessage& message) {
    const auto* data = reinterpret_cast<const char*>(message.data.data());
    reading.messages.push_back(message.topic.name + " " + std::to_string(message.time) + " " +
                               std::string(data, message.data.size()));
  };
  Diagnostics diagnostics;
  read(reader, diagnostics);
  reading.errors = std::move(diagnostics.errors);
  reading.warnings = std::move(diagnostics.warnings);
  return reading;
}

}  // namespace kinecal
