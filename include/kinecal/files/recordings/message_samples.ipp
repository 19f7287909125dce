// Samples from messages: robot_calibration_msgs/CalibrationData of a bag.
//
// A message is processed like a YAML document: as events through the SampleHandler.  So a bag and a
// YAML file with the same content give the same samples and the same errors.  The numbers of a
// message never become text, unless the handler expects a word.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/messages/value.hpp"
#include "kinecal/files/samples/sample_handler.ipp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

class MessageSamples {
 public:
  /// @param file  name of the bag in messages and in Sample::source
  explicit MessageSamples(std::string file) : file_(std::move(file)), handler_(file_) {}

  /// @param number  of the message among those of its kind, from 1; used instead of the line
  void add(const MessageFields& message, int number) {
    handler_.document_starts();
    emit(message, number);
  }

  [[nodiscard]] bool too_many_errors() { return handler_.builder().errors().too_many(); }

  [[nodiscard]] std::vector<Sample> take(Diagnostics& diagnostics) {
    report(handler_.builder().errors(), file_, diagnostics);
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
    value.visit_number([&](auto x) { handler_.number(number, x); });
  }

  std::string file_;
  SampleHandler handler_;
};

}  // namespace kinecal::detail
