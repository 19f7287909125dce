// What a configuration adds to samples before its error blocks see them: what the sample before had, planes and lines for each of
// their points.  Whatever holds samples against a configuration or its result does this first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Names of the conditions and joints of the sample before that error blocks take.
[[nodiscard]] std::set<std::string> looks_before(const Config& config);

/// Completes samples: set_before(), place_planes().
/// @param samples  in the order of their recordings
void complete_samples(const Config& config, std::vector<Sample>& samples);

}  // namespace kinecal
