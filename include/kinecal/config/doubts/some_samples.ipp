// Every n-th sample, if all of them would take too long.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// At most so many samples; 100 are enough to see what fits.
[[nodiscard]] inline std::vector<Sample> some_of(std::span<const Sample> samples,
                                                 std::size_t most = 100) {
  const std::size_t step = (samples.size() + most - 1) / most;
  std::vector<Sample> some;
  for (std::size_t i = 0; i < samples.size(); i += std::max<std::size_t>(step, 1)) {
    some.push_back(samples[i]);
  }
  return some;
}

}  // namespace kinecal::detail
