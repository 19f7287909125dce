// Definitions of marker_tags.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/tags/marker_tags.hpp"

#include <algorithm>

#include "kinecal/capture/boards/opencv_corners.hpp"
#include "kinecal/capture/tags/tag_edges.hpp"

namespace kinecal::detail {

bool is_marker_dictionary(const std::string& name) {
  const auto& names = marker_dictionaries();
  return std::find(names.begin(), names.end(), name) != names.end();
}

int marker_cells(const std::string& dictionary) {
  constexpr int kBorders = 2;
  if (dictionary == "DICT_ARUCO_ORIGINAL") return 5 + kBorders;
  if (dictionary == "DICT_APRILTAG_16h5") return 4 + kBorders;
  if (dictionary == "DICT_APRILTAG_25h9") return 5 + kBorders;
  if (dictionary.starts_with("DICT_APRILTAG_36")) return 6 + kBorders;
  return dictionary.at(std::string("DICT_").size()) - '0' + kBorders;  // DICT_4X4_50
}

std::vector<SeenTag> read_marker_tags(const GrayImage& image, const std::string& dictionary) {
  constexpr int kLeastSide = 32;
  if (image.width < kLeastSide || image.height < kLeastSide) return {};
  std::vector<SeenTag> tags;
  for (const Marker& marker : find_markers(image, dictionary)) {
    SeenTag tag{marker.id, marker.corners};
    std::reverse(tag.corners.begin(), tag.corners.end());  // from its bottom left, the other way
    refine_tag(image, (tag.corners[1] - tag.corners[0]).norm() / marker_cells(dictionary),
               tag.corners);
    tags.push_back(tag);
  }
  return tags;
}

}  // namespace kinecal::detail
