// Fields of messages by their paths: "header.stamp".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/capture/view.hpp"
#include "kinecal/files/messages/value.hpp"

namespace kinecal::detail {

/// nullptr if there is no such field.
[[nodiscard]] const MessageValue* field_at(const MessageFields& message, std::string_view path);

/// 0 if there is no such number.
[[nodiscard]] double number_at(const MessageFields& message, std::string_view path);

/// Empty if there is no such text.
[[nodiscard]] std::string_view text_at(const MessageFields& message, std::string_view path);

/// Empty if there is no such list.
[[nodiscard]] const MessageValue::List& list_at(const MessageFields& message,
                                                std::string_view path);

/// The stamp of a message's header.
[[nodiscard]] Stamp header_stamp(const MessageFields& message);

/// A time or duration as its two numbers, in either ROS.
[[nodiscard]] MessageFields time_fields(Stamp time);

/// A stamp as text: "12.345 s".
[[nodiscard]] std::string stamp_text(Stamp stamp);

}  // namespace kinecal::detail
