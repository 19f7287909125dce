// Writes samples for read_samples(): one YAML document each, with the keys of ROS 1.
//
// Numbers are the shortest text that reads back as the same double.  Sample::source is not written.
// An all-zero camera (see is_blank) reads back as no camera.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <vector>

#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Writes all samples in their order, each followed by `---`.
/// @throws std::invalid_argument  if the numbers of positions and joint names of a sample differ;
///                                the samples before it have then been written
void write_samples(std::ostream& out, const std::vector<Sample>& samples);

}  // namespace kinecal
