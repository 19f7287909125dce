// Builds messages for writing: fields by name, lists of numbers and texts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/messages/value.hpp"

namespace kinecal::detail {

/// Alternating names and values: fields("x", 1.0, "y", 2.0).
template <class... Rest>
[[nodiscard]] MessageFields fields(Rest&&... rest) {
  MessageFields result;
  const auto add = [&result]<class Next>(auto& self, std::string_view name, Next&& value,
                                         auto&&... others) -> void {
    result.fields.emplace_back(name, MessageValue(std::forward<Next>(value)));
    if constexpr (sizeof...(others) > 0) self(self, std::forward<decltype(others)>(others)...);
  };
  add(add, std::forward<Rest>(rest)...);
  return result;
}

template <class Range, class F>
[[nodiscard]] MessageValue::List list_of(const Range& range, F&& item) {
  MessageValue::List list;
  list.reserve(std::size(range));
  for (const auto& x : range) list.emplace_back(item(x));
  return list;
}

[[nodiscard]] MessageValue::List texts(const std::vector<std::string>& all);

template <class Range>
[[nodiscard]] MessageValue::List numbers(const Range& all) {
  return list_of(all, [](double x) { return x; });
}

}  // namespace kinecal::detail
