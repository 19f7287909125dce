// Checks what pulls at a robot: gravity, and the payload of samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Doubts: gravity that is not the earth's, in size; samples with a payload that no link carries.
void check_weight(const Config& config, std::span<const Sample> samples, Diagnostics& diagnostics);

}  // namespace kinecal::detail
