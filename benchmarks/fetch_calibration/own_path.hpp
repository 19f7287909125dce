// The library's own evaluation, as every calibration uses it: in doubles or in packets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "method.hpp"

namespace kinecal::bench {

/// "scalar" and "packets".
[[nodiscard]] std::vector<Method> own_methods(const FetchWork& work);

}  // namespace kinecal::bench
