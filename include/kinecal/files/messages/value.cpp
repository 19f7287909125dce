// Definitions of value.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/messages/value.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace kinecal {
namespace detail {
namespace {

[[nodiscard]] bool same_field(std::string_view a, std::string_view b) {
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

}  // namespace
}  // namespace detail

const MessageValue* MessageFields::find(std::string_view name) const {
  for (const auto& [field, value] : fields) {
    if (detail::same_field(field, name)) return &value;
  }
  return nullptr;
}

}  // namespace kinecal
