// How the tags of a grid lie on it: found from a view that contradicts the settings.
//
// OpenCV draws AprilTags turned by 180 degrees, and boards with the first row on top.  Such tags are
// taken as they are.  Another number of columns, or another gap, is named.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/capture/finders/april_tag_finder.hpp"

namespace kinecal::detail {

/// A tag's corner on the target, counter-clockwise from its bottom left.
[[nodiscard]] Vector3<double> tag_corner(const PlacedTag& tag, int k);

/// The tags of a grid as its settings say.
[[nodiscard]] std::vector<PlacedTag> grid_tags(const AprilTagSettings& settings);

/// What a view says of its grid.
struct TagLayout {
  std::string fault;  ///< what in the settings is wrong, with the right number; empty: nothing
  std::string note;   ///< how the tags are turned; empty: as the settings say
};

/// Takes tags as they are turned on their grid.
/// @param corners  of all tags in a view, with ids 4 tag + k; get other places if tags are turned
[[nodiscard]] TagLayout arrange_tags(const AprilTagSettings& settings, const CameraInfo& camera,
                                     std::vector<TargetCorner>& corners);

}  // namespace kinecal::detail
