// Markers of ArUco as tags: they take the place of AprilTags in a grid, or alone.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/capture/tags/april_tags.hpp"

namespace kinecal::detail {

/// True for names in marker_dictionaries().
[[nodiscard]] bool is_marker_dictionary(const std::string& name);

/// Number of cells along a marker's side, including its border of one.
/// @param dictionary  one of marker_dictionaries()
[[nodiscard]] int marker_cells(const std::string& dictionary);

/// The markers in an image, with sub-pixel corners.  Needs OpenCV's module aruco.
/// @param dictionary  one of marker_dictionaries()
[[nodiscard]] std::vector<SeenTag> read_marker_tags(const GrayImage& image,
                                                    const std::string& dictionary);

}  // namespace kinecal::detail
