// Every n-th sample, if all of them would take too long.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// At most so many samples; 100 are enough to see what fits.
[[nodiscard]] std::vector<Sample> some_of(std::span<const Sample> samples, std::size_t most = 100);

}  // namespace kinecal::detail
