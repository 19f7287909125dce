// Definitions of message_fields.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/message_fields.hpp"

#include <cstdint>
#include <vector>

namespace kinecal::detail {

const MessageValue* field_at(const MessageFields& message, std::string_view path) {
  const std::size_t dot = path.find('.');
  const MessageValue* value = message.find(path.substr(0, dot));
  if (value == nullptr || dot == std::string_view::npos) return value;
  const auto* inner = value->as<MessageFields>();
  return inner == nullptr ? nullptr : field_at(*inner, path.substr(dot + 1));
}

double number_at(const MessageFields& message, std::string_view path) {
  double result = 0.0;
  if (const MessageValue* value = field_at(message, path)) {
    value->visit_number([&](auto x) { result = static_cast<double>(x); });
  }
  return result;
}

std::string_view text_at(const MessageFields& message, std::string_view path) {
  const MessageValue* value = field_at(message, path);
  const auto* text = value == nullptr ? nullptr : value->as<std::string_view>();
  return text == nullptr ? std::string_view() : *text;
}

const MessageValue::List& list_at(const MessageFields& message, std::string_view path) {
  static const MessageValue::List kEmpty;
  const MessageValue* value = field_at(message, path);
  const auto* list = value == nullptr ? nullptr : value->as<MessageValue::List>();
  return list == nullptr ? kEmpty : *list;
}

Stamp header_stamp(const MessageFields& message) {
  return std::chrono::seconds(static_cast<std::int64_t>(number_at(message, "header.stamp.sec"))) +
         Stamp(static_cast<std::int64_t>(number_at(message, "header.stamp.nanosec")));
}

MessageFields time_fields(Stamp time) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  MessageFields fields;
  fields.fields.emplace_back("sec", MessageValue(std::int64_t{time.count() / kSecond}));
  fields.fields.emplace_back("nanosec", MessageValue(std::int64_t{time.count() % kSecond}));
  return fields;
}

std::string stamp_text(Stamp stamp) {
  const auto milliseconds = stamp.count() / 1'000'000;
  const bool negative = milliseconds < 0;
  const auto whole = negative ? -milliseconds : milliseconds;
  std::string rest = std::to_string(whole % 1000);
  rest.insert(0, 3 - rest.size(), '0');
  return (negative ? "-" : "") + std::to_string(whole / 1000) + "." + rest + " s";
}

}  // namespace kinecal::detail
