// The messages of a bag that kinecal can use, decoded by the definition that the bag carries.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "kinecal/io/bags/bag.hpp"
#include "kinecal/io/diagnostics.hpp"
#include "kinecal/io/messages/decode.hpp"
#include "kinecal/io/messages/known_definitions.hpp"

namespace kinecal {

/// What a topic is good for.
enum class TopicUse { none, samples, poses, urdf };

[[nodiscard]] inline TopicUse use_of(const BagTopic& topic) {
  if (topic.type == "robot_calibration_msgs/CalibrationData") return TopicUse::samples;
  if (topic.type == "robot_calibration_msgs/CaptureConfig") return TopicUse::poses;
  if (topic.type == "sensor_msgs/JointState") return TopicUse::poses;
  const bool is_urdf = topic.type == "std_msgs/String" && topic.name.ends_with("robot_description");
  return is_urdf ? TopicUse::urdf : TopicUse::none;
}

/// Decodes messages, and says why they cannot be: once for each definition, and for the first
/// messages.
class MessageDecoder {
 public:
  /// @param file  as messages name it
  MessageDecoder(std::string file, Diagnostics& diagnostics)
      : file_(std::move(file)), diagnostics_(diagnostics) {}

  /// @param number  of the message on its topic, from 1
  /// @return        views of the message; nothing if it is none of its type
  [[nodiscard]] std::optional<MessageFields> decode(const BagMessage& message, int number) {
    const MessageDefinition* definition = definition_of(message.topic);
    if (definition == nullptr) return std::nullopt;
    try {
      return kinecal::decode(*definition, message.topic.encoding, message.data);
    } catch (const BytesError& e) {
      if (++mistakes_ <= kMostMistakes) {
        diagnostics_.error({file_, 0},
                           fmt::format("message {} of topic '{}' is no {}: {}", number,
                                       message.topic.name, message.topic.type, e.what()));
      } else if (mistakes_ == kMostMistakes + 1) {
        diagnostics_.error({file_, 0}, "more messages cannot be read; the rest is not told");
      }
      return std::nullopt;
    }
  }

  /// nullptr if there is none, which has been told.
  [[nodiscard]] const MessageDefinition* definition_of(const BagTopic& topic) {
    const auto key = std::tie(topic.type, topic.definition);
    auto found = definitions_.find(key);
    if (found == definitions_.end()) found = definitions_.emplace(key, parse(topic)).first;
    return found->second ? &*found->second : nullptr;
  }

 private:
  [[nodiscard]] std::optional<MessageDefinition> parse(const BagTopic& topic) {
    try {
      return parse_definition(topic.type, topic.definition.empty()
                                              ? known_definition(topic.type, topic.encoding)
                                              : topic.definition);
    } catch (const DefinitionError& e) {
      diagnostics_.error({file_, 0}, fmt::format("topic '{}': the definition of {} in this bag: {}",
                                                 topic.name, topic.type, e.what()));
      return std::nullopt;
    }
  }

  static constexpr int kMostMistakes = 20;  ///< the rest are usually the same one again

  std::string file_;
  int mistakes_ = 0;
  Diagnostics& diagnostics_;
  /// By type and text.
  std::map<std::tuple<std::string, std::string>, std::optional<MessageDefinition>, std::less<>>
      definitions_;
};

}  // namespace kinecal
