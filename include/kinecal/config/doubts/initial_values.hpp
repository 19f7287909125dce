// Checks initial values of a configuration: degrees, millimetres, absurd numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// Error: an absurd number.  Doubt: a frame that starts more than a turn away, which looks like
/// degrees, or more than 100 m, which looks like millimetres.
void check_initial_values(const Config& config, Diagnostics& diagnostics);

}  // namespace kinecal::detail
