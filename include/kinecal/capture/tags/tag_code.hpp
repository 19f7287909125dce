// The code of an AprilTag, read between corners that are already known.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "kinecal/capture/image.hpp"

namespace kinecal::detail {

/// A family of tags with a black border.  A tag is 1 wide; x goes right and y up from its bottom left.
struct TagCodes {
  int cells = 8;                             ///< along a side, including the border
  int border = 1;                            ///< width of the black border, cells
  int distance = 11;                         ///< bits in which any two codes differ
  std::vector<std::uint64_t> codes = {};     ///< by id; the first bit is the highest
  std::vector<Eigen::Vector2d> places = {};  ///< centres of the bits, in the order of the code
};

/// What a code says.
struct TagReading {
  int id = 0;
  int turns = 0;       ///< which of the corners given is the tag's bottom left, 0 to 3
  int wrong_bits = 0;  ///< that differ from the code of the family
};

/// The tag between four corners, in any of its four orientations.
/// @param corners  (2) pixels each, counter-clockwise
/// @returns        nullopt if there is no contrast, or no code with at most so many wrong bits
[[nodiscard]] std::optional<TagReading> read_code(const GrayImage& image, const TagCodes& codes,
                                                  const std::array<Eigen::Vector2d, 4>& corners,
                                                  int wrong_bits);

/// Corners of a tag that is 1 wide, counter-clockwise from its bottom left.
[[nodiscard]] const std::vector<Eigen::Vector2d>& unit_tag();

}  // namespace kinecal::detail
