// Layouts of a grid of tags, for tag_layout.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "kinecal/capture/tag_layout.hpp"

namespace kinecal::detail {

/// Another layout of a grid.
struct TagPlan {
  AprilTagSettings grid;
  int turns = 0;           ///< of each tag on the grid, quarters counter-clockwise
  bool rows_down = false;  ///< the first row is on top
};

/// The place of a tag, on a grid that may have any number of rows.
[[nodiscard]] inline PlacedTag place_of(const TagPlan& plan, int id) {
  const AprilTagSettings& s = plan.grid;
  const int number = id - s.first_id, column = number % s.columns;
  int row = number / s.columns;
  if (plan.rows_down) row = s.rows - 1 - row;
  const double pitch = s.size * (1.0 + s.spacing), half = s.size / 2.0;
  return {id, s.size, {column * pitch + half, row * pitch + half, 0.0}};
}

/// The corners of a view where a plan has them.
[[nodiscard]] inline std::vector<TargetCorner> arranged(const TagPlan& plan,
                                                        std::vector<TargetCorner> corners) {
  for (TargetCorner& corner : corners) {
    const int tag = corner.id / 4, k = (corner.id + plan.turns) % 4;
    corner.id = 4 * tag + k;
    corner.target = tag_corner(place_of(plan, tag), k);
  }
  return corners;
}

/// The middles of tags, as corners: they do not show how the tags are turned.
[[nodiscard]] inline std::vector<TargetCorner> middles(const std::vector<TargetCorner>& corners) {
  std::vector<TargetCorner> all;
  for (std::size_t i = 0; i + 3 < corners.size(); i += 4) {
    TargetCorner middle = corners[i];
    middle.pixel = 0.25 * (corners[i].pixel + corners[i + 1].pixel + corners[i + 2].pixel +
                           corners[i + 3].pixel);
    middle.target = 0.25 * (corners[i].target + corners[i + 1].target + corners[i + 2].target +
                            corners[i + 3].target);
    all.push_back(middle);
  }
  return all;
}

}  // namespace kinecal::detail
