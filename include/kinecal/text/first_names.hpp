// The first of many names, in messages.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace kinecal {

/// "a, b, c, d and 3 more".
[[nodiscard]] inline std::string first_names(const std::vector<std::string>& names) {
  constexpr std::size_t kShown = 4;
  std::string text;
  for (std::size_t i = 0; i < std::min(kShown, names.size()); ++i) {
    text += (i == 0 ? "" : ", ") + names[i];
  }
  if (names.size() <= kShown) return text;
  return text + " and " + std::to_string(names.size() - kShown) + " more";
}

}  // namespace kinecal
