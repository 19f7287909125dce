// The content of a message of any type: numbers, texts, lists and what has named fields.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "kinecal/io/bags/bytes.hpp"

namespace kinecal {

struct MessageValue;

/// Fields in the order of their definition.  Names are those of the definition, which must outlive
/// this.
struct MessageFields {
  std::vector<std::pair<std::string_view, MessageValue>> fields;

  /// The field of a name, or nullptr.  ROS 1 and 2 differ in capitals (D K R P) and in `secs`.
  [[nodiscard]] const MessageValue* find(std::string_view name) const;
};

/// Texts and bytes are views of the message that was decoded, which must outlive this.
struct MessageValue : std::variant<std::int64_t, std::uint64_t, double, std::string_view, Bytes,
                                   std::vector<MessageValue>, MessageFields> {
  using List = std::vector<MessageValue>;
  using variant::variant;

  template <class T>
  [[nodiscard]] const T* as() const {
    return std::get_if<T>(static_cast<const variant*>(this));
  }

  /// Calls f with the number that this is, if it is one.
  template <class F>
  void visit_number(F&& f) const {
    if (const auto* i = as<std::int64_t>()) f(*i);
    if (const auto* u = as<std::uint64_t>()) f(*u);
    if (const auto* x = as<double>()) f(*x);
  }
};

namespace detail {

[[nodiscard]] inline bool same_field(std::string_view a, std::string_view b) {
  const auto plain = [](std::string_view name) {
    return name == "secs" ? "sec" : name == "nsecs" ? "nanosec" : name;
  };
  a = plain(a);
  b = plain(b);
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) {
           return std::tolower(static_cast<unsigned char>(x)) ==
                  std::tolower(static_cast<unsigned char>(y));
         });
}

}  // namespace detail

inline const MessageValue* MessageFields::find(std::string_view name) const {
  for (const auto& [field, value] : fields) {
    if (detail::same_field(field, name)) return &value;
  }
  return nullptr;
}

}  // namespace kinecal
