// Decodes the messages of a bag with the bag's own definitions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/messages/decode.hpp"
#include "kinecal/files/messages/known_definitions.hpp"

namespace kinecal::detail {

/// Decodes messages and reports failures: once per definition, and for the first messages.
class MessageDecoder {
 public:
  /// @param file  name of the bag in messages
  MessageDecoder(std::string file, Diagnostics& diagnostics)
      : file_(std::move(file)), diagnostics_(diagnostics) {}

  /// @param number  of the message on its topic, from 1
  /// @return        views of the message; nullopt if its bytes do not match its type
  [[nodiscard]] std::optional<MessageFields> decode(const BagMessage& message, int number) {
    const MessageDefinition* definition = definition_of(message.topic);
    if (definition == nullptr) return std::nullopt;
    try {
      return detail::decode(*definition, message.topic.encoding, message.data);
    } catch (const BytesError& e) {
      if (++errors_ <= kMostErrors) {
        diagnostics_.error({file_, 0},
                           fmt::format("message {} of topic '{}' is not a {}: {}", number,
                                       message.topic.name, message.topic.type, e.what()));
      } else if (errors_ == kMostErrors + 1) {
        diagnostics_.error({file_, 0},
                           fmt::format("more than {} messages cannot be read; the rest are not "
                                       "listed",
                                       kMostErrors));
      }
      return std::nullopt;
    }
  }

 private:
  /// nullptr if the topic has no readable definition, which has been reported.
  [[nodiscard]] const MessageDefinition* definition_of(const BagTopic& topic) {
    const auto key = std::tie(topic.type, topic.definition);
    auto found = definitions_.find(key);
    if (found == definitions_.end()) found = definitions_.emplace(key, parse(topic)).first;
    return found->second ? &*found->second : nullptr;
  }

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

  static constexpr int kMostErrors = 20;  ///< the rest usually have the same cause

  std::string file_;
  int errors_ = 0;
  Diagnostics& diagnostics_;
  /// By type and text.
  std::map<std::tuple<std::string, std::string>, std::optional<MessageDefinition>, std::less<>>
      definitions_;
};

}  // namespace kinecal::detail
