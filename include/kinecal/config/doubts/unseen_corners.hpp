// Corners that were not seen, but are in the samples: some detectors write (-1, -1) or (0, 0) for them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Reports features of a camera at (-1, -1), and two of one sample at (0, 0): no corner that was seen is there.
void check_unseen(const std::string& camera, std::span<const Sample> samples,
                  Diagnostics& diagnostics);

}  // namespace kinecal::detail
