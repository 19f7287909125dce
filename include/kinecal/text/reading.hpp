// Numbers in readable units.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/linkage.hpp"

namespace kinecal {

/// A number in a readable unit: "3.4 mm", "0.21 deg", "1.2 px", "0.004".
[[nodiscard]] std::string reading(double value, std::string_view unit);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/text/reading.ipp"
#endif
