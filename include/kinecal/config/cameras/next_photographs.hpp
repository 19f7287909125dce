// Which photographs to take next for the lens of a camera: what all those so far lack.
//
//   regions    ninths of the image in which no feature is: a lens is known where features are
//   tilt       without it, the focal length and the distance look alike.  Of a homography H of a flat target, the depths
//              of two of its points are as (h31 x + h32 y + h33); the largest ratio counts
//   distances  of a view, sqrt(area of the target's image / area of the target)
//
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// What to do next, a sentence for each camera that lacks something: "for the lens of 'eye': hold the target at the upper
/// left of its image; tilt it".  Cameras whose samples have pixels and the size of the image.
[[nodiscard]] std::vector<std::string> next_photographs(std::span<const Sample> samples);

}  // namespace kinecal
