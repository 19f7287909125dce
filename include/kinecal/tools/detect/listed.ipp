// Lists of names in messages.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "kinecal/text/printable.hpp"

namespace kinecal::detail {

/// "'a', 'b'"; only the first if there are many.
template <class Names>
[[nodiscard]] std::string listed(const Names& names) {
  constexpr std::size_t kMost = 6;
  std::string text;
  std::size_t count = 0;
  for (const std::string& name : names) {
    if (count++ == kMost) return text + " ...";
    text += (text.empty() ? "'" : ", '") + printable(name) + "'";
  }
  return text;
}

}  // namespace kinecal::detail
