// Definitions of some_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/some_samples.hpp"

#include <algorithm>

namespace kinecal::detail {

std::vector<Sample> some_of(std::span<const Sample> samples, std::size_t most) {
  const std::size_t step = (samples.size() + most - 1) / most;
  std::vector<Sample> some;
  for (std::size_t i = 0; i < samples.size(); i += std::max<std::size_t>(step, 1)) {
    some.push_back(samples[i]);
  }
  return some;
}

}  // namespace kinecal::detail
