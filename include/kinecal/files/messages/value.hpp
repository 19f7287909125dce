// The content of a message of any type: numbers, texts, lists and messages with named fields.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "kinecal/files/bags/bytes.hpp"

namespace kinecal {

struct MessageValue;

/// The fields of a message, in the order of its definition.  The names are views of the definition,
/// which must outlive this.
struct MessageFields {
  /// Name and value.
  std::vector<std::pair<std::string_view, MessageValue>> fields;

  /// The field with this name, or nullptr.  ROS 1 and ROS 2 spellings are equivalent: D K R P and d
  /// k r p, `secs` and `sec`, `nsecs` and `nanosec`.
  [[nodiscard]] const MessageValue* find(std::string_view name) const;
};

/// A value of a message.  Texts and bytes are views of the decoded message, which must outlive
/// this.
struct MessageValue : std::variant<std::int64_t, std::uint64_t, double, std::string_view, Bytes,
                                   std::vector<MessageValue>, MessageFields> {
  /// The values of a list.
  using List = std::vector<MessageValue>;
  using variant::variant;

  /// The value if it has this type, else nullptr.
  template <class T>
  [[nodiscard]] const T* as() const {
    return std::get_if<T>(static_cast<const variant*>(this));
  }

  /// Calls f with the number (std::int64_t, std::uint64_t or double) if this value is one.
  template <class F>
  void visit_number(F&& f) const {
    if (const auto* i = as<std::int64_t>()) f(*i);
    if (const auto* u = as<std::uint64_t>()) f(*u);
    if (const auto* x = as<double>()) f(*x);
  }
};

}  // namespace kinecal
