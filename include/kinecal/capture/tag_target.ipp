// The tags of a target by its settings, for april_tag_finder.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/capture/april_tag_finder.hpp"
#include "kinecal/capture/marker_tags.hpp"
#include "kinecal/capture/tag_layout.hpp"
#include "kinecal/capture/touching_tags.hpp"

namespace kinecal::detail {

/// The tags of a target, in the order of their ids.
[[nodiscard]] inline std::vector<PlacedTag> all_tags(const AprilTagSettings& s) {
  std::vector<PlacedTag> tags = grid_tags(s);
  tags.insert(tags.end(), s.tags.begin(), s.tags.end());
  std::sort(tags.begin(), tags.end(),
            [](const PlacedTag& a, const PlacedTag& b) { return a.id < b.id; });
  return tags;
}

/// Where squares may touch tags: single tags have none.
[[nodiscard]] inline TouchingGrid touching_grid(const AprilTagSettings& s) {
  TouchingGrid grid{s.spacing, s.max_wrong_bits};
  for (const PlacedTag& tag : grid_tags(s)) grid.ids.push_back(tag.id);
  return grid;
}

/// @throws std::invalid_argument  if a target is impossible
inline void check_tags(const AprilTagSettings& s, const std::vector<PlacedTag>& tags) {
  if (tags.empty()) {
    throw std::invalid_argument("a target of AprilTags needs columns and rows of a grid, or tags");
  }
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const std::string name = "AprilTag " + std::to_string(tags[i].id);
    if (!(tags[i].size > 0.0) || tags[i].id < 0) {
      throw std::invalid_argument(name + " has a size of " + std::to_string(tags[i].size) +
                                  " m: sizes must be positive, ids not negative");
    }
    if (i > 0 && tags[i].id == tags[i - 1].id) {
      throw std::invalid_argument(name + " is on the target twice");
    }
  }
  if (!(s.spacing >= 0.0) || !(s.min_side > 0.0) || !(s.decimate >= 1.0) || s.min_tags < 1 ||
      s.border < 1 || s.border > 4 || s.max_wrong_bits < 0 || s.max_wrong_bits > 2) {
    throw std::invalid_argument(
        "AprilTags: spacing >= 0, min_side > 0, decimate >= 1, min_tags >= 1, border 1 to 4 and "
        "max_wrong_bits 0 to 2 are possible");
  }
  if (is_marker_dictionary(s.family) && s.border != 1) {
    throw std::invalid_argument("markers of " + s.family + " have a border of 1 bit");
  }
}

}  // namespace kinecal::detail
