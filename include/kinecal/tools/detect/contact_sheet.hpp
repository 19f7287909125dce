// Contact sheets: pictures of all views with their features and the grid that was fitted to them, for a quick look.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/capture/view.hpp"

namespace kinecal {

/// A small picture of a view.
struct Thumbnail {
  GrayImage image;                  ///< at most kMostThumbnailWidth wide
  std::vector<Mark> marks;          ///< in its pixels; `off` in those of the view
  std::string name;                 ///< of the image
  std::string refusal;              ///< why nothing was found; empty if something was
  std::vector<GridLine> grid = {};  ///< in its pixels
};

/// Widths of thumbnails, pixels.  Images that are wider than the least are shrunk by whole numbers to no less: a
/// corner that is 3 pixels off in an image twice as wide shows.
inline constexpr int kThumbnailWidth = 640, kMostThumbnailWidth = 2 * kThumbnailWidth - 1;
/// Views of a sheet.
inline constexpr std::size_t kViewsOfSheet = 24;

/// Shrinks an image by averaging, with its marks and lines.
[[nodiscard]] Thumbnail thumbnail(const GrayImage& image, std::vector<Mark> marks,
                                  const std::string& name, const std::string& refusal,
                                  std::vector<GridLine> grid = {});

/// HTML pages of all views, kViewsOfSheet each, without scripts and other files.  Features are green crosses; thin
/// blue lines are the grid that was fitted to them, so that a wrong corner lies beside its lines; corners that were
/// dropped are magenta.  An orange square is around the first corner, and an arrow leads to the next.  Without a grid,
/// dotted lines join neighbours in the order of their ids.  Below are the number of the view, its name and the RMS
/// distance of corners and grid.  A view without features has a red frame and the reason below.  Marks far outside an
/// image are left out.
/// @param earlier  views_of_sheet() of an interrupted session: they come first, and numbers go on after them
/// @throws std::invalid_argument  if there are no views, or an image is empty
[[nodiscard]] std::vector<std::string> contact_sheets(const std::vector<Thumbnail>& thumbnails,
                                                      const std::vector<std::string>& earlier = {});

/// The views of a page that contact_sheets() wrote, as HTML.
/// @return  nullopt if it did not write this text
[[nodiscard]] std::optional<std::vector<std::string>> views_of_sheet(std::string_view page);

/// The name of a sheet's file: that of the first; "sheet-2.html" of the second of "sheet.html".  "sheet.png", as sheets
/// were once written, is "sheet.html".
/// @param number  from 0
[[nodiscard]] std::string sheet_name(const std::string& first, std::size_t number);

}  // namespace kinecal
