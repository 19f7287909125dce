// Samples from messages: robot_calibration_msgs/CalibrationData of a bag.
//
// A message goes the way that a YAML document goes: as events through the SampleHandler.  So the
// same sample, and the same words for what is wrong with it, come from any file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/io/diagnostics.hpp"
#include "kinecal/io/messages/value.hpp"
#include "kinecal/io/samples/sample_handler.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

class MessageSamples {
 public:
  /// @param file  as messages and Sample::source name it
  explicit MessageSamples(std::string file) : file_(std::move(file)), handler_(file_) {}

  /// @param number  of the message among those of its kind, from 1; stands for the line
  void add(const MessageFields& message, int number) {
    handler_.document_starts();
    emit(message, number);
  }

  [[nodiscard]] bool too_many_errors() { return handler_.builder().errors().too_many(); }

  [[nodiscard]] std::vector<Sample> take(Diagnostics& diagnostics) {
    tell(handler_.builder().errors(), file_, diagnostics);
    return handler_.take();
  }

 private:
  void emit(const MessageFields& message, int number) {
    handler_.map_starts(number);
    if (!handler_.skips()) {
      for (const auto& [name, value] : message.fields) {
        handler_.scalar(number, name);
        emit(value, number);
      }
    }
    handler_.ends();
  }

  void emit(const MessageValue& value, int number) {
    if (const auto* message = value.as<MessageFields>()) return emit(*message, number);
    if (const auto* text = value.as<std::string_view>()) return handler_.scalar(number, *text);
    if (const auto* list = value.as<MessageValue::List>()) {
      handler_.list_starts(number);
      if (!handler_.skips()) {
        for (const MessageValue& item : *list) emit(item, number);
      }
      handler_.ends();
    } else if (value.as<Bytes>() != nullptr) {  // images and clouds
      handler_.list_starts(number);
      handler_.ends();
    }
    value.visit_number([&](auto x) { handler_.scalar(number, format(x)); });
  }

  /// Digits enough to be read as the same number again.
  template <class X>
  [[nodiscard]] std::string_view format(X x) {
    const auto end = fmt::format_to_n(digits_.begin(), digits_.size(), "{}", x).out;
    return {digits_.begin(), end};
  }

  std::string file_;
  SampleHandler handler_;
  std::array<char, 40> digits_{};
};

}  // namespace kinecal::detail
