// Wraps libapriltag: finds tags in an image, with sub-pixel corners.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "kinecal/capture/image.hpp"
#include "kinecal/capture/tags/tag_code.hpp"

namespace kinecal::detail {

/// A tag in an image: corners counter-clockwise from its bottom left.
struct SeenTag {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners = {};  ///< pixels
};

/// Why this build cannot find tags; empty if it can.
[[nodiscard]] std::string april_tag_fault();

/// A detector for one family of tags.
class TagReader {
 public:
  /// @param border      bits of the black border
  /// @param wrong_bits  number of code bits to correct
  /// @param decimate    factor by which the searched image is smaller
  /// @throws std::invalid_argument  if the family is unknown, or has a border that cannot be
  ///                                changed
  TagReader(const std::string& family, int border, int wrong_bits, double decimate);

  /// The tags in an image; empty if it is less than 32 pixels wide or high.
  [[nodiscard]] std::vector<SeenTag> read(const GrayImage& image) const;

  /// The tags in an image, searched at its full size, with corners as libapriltag finds them.
  [[nodiscard]] std::vector<SeenTag> read_roughly(const GrayImage& image) const;

  /// The codes of the family; empty if its tags have no black border, or without libapriltag.
  [[nodiscard]] const TagCodes& codes() const { return codes_; }

  /// Number of cells along a tag's side, including the border.
  [[nodiscard]] double cells() const;

 private:
  struct Library;
  std::unique_ptr<Library, void (*)(Library*)> library_;
  TagCodes codes_;
};

}  // namespace kinecal::detail
