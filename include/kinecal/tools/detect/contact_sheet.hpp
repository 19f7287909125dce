// A contact sheet: one picture of all views with their features, for a quick look.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/capture/view.hpp"

namespace kinecal {

/// A small picture of a view.
struct Thumbnail {
  GrayImage image;          ///< at most kThumbnailWidth wide
  std::vector<Mark> marks;  ///< in its pixels
  std::string name;         ///< of the image
  std::string refusal;      ///< why nothing was found; empty if something was
};

/// Width of a thumbnail, pixels: a corner that is 3 pixels off in an image twice as wide shows.
inline constexpr int kThumbnailWidth = 640;

/// Shrinks an image by averaging, with its marks.
[[nodiscard]] Thumbnail thumbnail(const GrayImage& image, std::vector<Mark> marks,
                                  const std::string& name, const std::string& refusal);

/// A PNG of all views: features are marked green, and neighbours in the order of their ids joined by
/// dotted lines, so that a wrong corner bends its row or its tag.  A view without any has a red frame
/// and the reason below.
/// @throws std::invalid_argument  if there are no views
[[nodiscard]] std::string contact_sheet(const std::vector<Thumbnail>& thumbnails);

}  // namespace kinecal
