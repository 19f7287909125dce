// The median of numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

namespace kinecal {

/// The median; of an even count, the larger of the two in the middle.
/// @param numbers  at least one; move them here if they are not needed any more
template <class T>
[[nodiscard]] T median_of(std::vector<T> numbers) {
  const auto middle = numbers.begin() + std::ssize(numbers) / 2;
  std::nth_element(numbers.begin(), middle, numbers.end());
  return *middle;
}

}  // namespace kinecal
