// Definitions of convert.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/recordings/convert.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/message_decoder.ipp"
#include "kinecal/files/recordings/read_bag.hpp"
#include "kinecal/files/recordings/sample_message.ipp"

namespace kinecal {
namespace detail {
namespace {

/// The message without images and point clouds, which calibration does not use.
[[nodiscard]] MessageFields without_clouds(const MessageFields& message) {
  MessageFields kept = message;
  for (auto& [name, value] : kept.fields) {
    auto* seen = std::get_if<MessageValue::List>(static_cast<MessageValue::variant*>(&value));
    if (name != "observations" || seen == nullptr) continue;
    for (MessageValue& one : *seen) {
      if (auto* fields = std::get_if<MessageFields>(static_cast<MessageValue::variant*>(&one))) {
        std::erase_if(fields->fields, [](const auto& field) {
          return field.first == "cloud" || field.first == "image";
        });
      }
    }
  }
  return kept;
}

}  // namespace
}  // namespace detail

std::size_t convert_bag(const std::string& from, BagOutput& to, Clouds clouds,
                        Diagnostics& diagnostics) {
  detail::MessageDecoder decoder(from, diagnostics);
  std::set<std::string> left_out, refused;
  std::size_t written = 0;
  int number = 0;
  const auto wants = [&](const BagTopic& topic) {
    const bool known = !detail::known_definition(topic.type, to.encoding()).empty();
    const bool copied = topic.encoding == to.encoding() && !topic.definition.empty();
    if (!known && !copied) left_out.insert(topic.name);
    return known || copied;
  };
  const auto write = [&](const BagMessage& message) {
    const BagTopic& topic = message.topic;
    const bool drops = clouds == Clouds::drop && use_of(topic) == TopicUse::samples;
    if (topic.encoding == to.encoding() && !drops && !topic.definition.empty()) {
      to.copy(topic, message.time, message.data);
    } else if (const auto content = decoder.decode(message, number)) {
      to.write(topic, message.time, drops ? detail::without_clouds(*content) : *content);
    } else {
      return;
    }
    ++written;
  };
  const auto handle = [&](const BagMessage& message) {
    ++number;
    try {
      write(message);
    } catch (const std::invalid_argument& e) {  // reported once for each topic
      if (!refused.insert(message.topic.name).second) return;
      diagnostics.error({from, 0}, fmt::format("message {} of topic '{}' cannot be written: {}",
                                               number, message.topic.name, e.what()));
    }
  };
  read_bag(from, {wants, handle}, diagnostics);
  for (const std::string& name : left_out) {
    diagnostics.warning({from, 0}, fmt::format("topic '{}' is left out: kinecal cannot convert "
                                               "messages of its type",
                                               name));
  }
  return written;
}

void write_samples(BagOutput& to, const std::vector<Sample>& samples) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const BagTopic topic{"calibration_data", "robot_calibration_msgs/CalibrationData", {}, {}, {}};
  std::int64_t time = 0;
  for (const Sample& sample : samples) {
    std::deque<std::string> texts;
    to.write(topic, time += kSecond, detail::sample_message(sample, texts));
  }
}

void write_urdf(BagOutput& to, const std::string& urdf) {
  to.write({"robot_description", "std_msgs/String", {}, {}, {}}, 1,
           detail::fields("data", std::string_view(urdf)));
}

}  // namespace kinecal
