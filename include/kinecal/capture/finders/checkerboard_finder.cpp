// Definitions of checkerboard_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/checkerboard_finder.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "kinecal/capture/boards/board_order.hpp"
#include "kinecal/capture/boards/grid_corners.hpp"
#include "kinecal/capture/boards/opencv_corners.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The result of a search for boards.
struct BoardsSeen {
  std::vector<CornerGrid> boards;  ///< of the right size
  bool larger = false;             ///< found as part of a larger board
};

/// Boards of one size, two at most.  Paints over each board found and searches again: a larger
/// board is not the one, and a second one must not be mistaken for it.  A reduced image takes a fraction of
/// the time and shows most boards; a larger one is searched for what it does not show.
[[nodiscard]] BoardsSeen search_boards(const GrayImage& image, int columns, int rows) {
  constexpr double kReduced = 800.0, kLargest = 1600.0,
                   kForSquares = 640.0;  // longest sides, pixels
  BoardsSeen seen;
  GrayImage left = image;
  const auto search = [&](BoardSearch how, double longest) {
    for (int tries = 0; tries < 4 && seen.boards.size() < 2; ++tries) {
      const CornerGrid grid{columns, rows, find_chessboard(left, columns, rows, how, longest)};
      if (grid.corners.empty()) return;
      if (is_checkerboard(image, grid)) {
        if (goes_on(image, grid)) {
          seen.larger = true;
        } else {
          seen.boards.push_back(grid);
        }
      }
      paint_over(grid, left);
    }
  };
  search(BoardSearch::sectors, kReduced);
  if (seen.boards.empty() && std::max(image.width, image.height) > kReduced) {
    search(BoardSearch::sectors, kLargest);
  }
  // Finds small boards, and one beside another of another size.
  if (seen.boards.empty()) search(BoardSearch::squares, kForSquares);
  return seen;
}

/// "checkerboard of 5 x 4 corners"
[[nodiscard]] std::string board_text(const CheckerboardSettings& s) {
  return "checkerboard of " + std::to_string(s.points_x) + " x " + std::to_string(s.points_y) +
         " corners";
}

/// True if a board cannot be in an image in any orientation: its squares need 4 pixels.
[[nodiscard]] bool too_small_for(const GrayImage& image, const CheckerboardSettings& s) {
  constexpr int kLeastSquare = 4;
  const int across = kLeastSquare * (std::min(s.points_x, s.points_y) + 1);
  const int along = kLeastSquare * (std::max(s.points_x, s.points_y) + 1);
  return std::min(image.width, image.height) < across ||
         std::max(image.width, image.height) < along;
}

/// Half the side of a window that holds one corner and no other.
[[nodiscard]] int window_reach(double side) {
  return std::clamp(static_cast<int>(side / 3.0), 2, 12);
}

/// True if a corner is nearer to the border than this.
[[nodiscard]] bool corners_at_border(const GrayImage& image,
                                     const std::vector<Eigen::Vector2d>& corners, double margin) {
  return std::any_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& c) {
    return !(c.x() >= margin && c.y() >= margin && c.x() <= image.width - 1 - margin &&
             c.y() <= image.height - 1 - margin);
  });
}

}  // namespace
}  // namespace detail

CheckerboardFinder::CheckerboardFinder(CheckerboardSettings settings)
    : settings_(std::move(settings)) {
  if (settings_.points_x < 3 || settings_.points_y < 3) {
    throw std::invalid_argument("a " + detail::board_text(settings_) +
                                ": it needs at least 3 x 3 inner corners");
  }
  if (!(settings_.size > 0.0)) {
    throw std::invalid_argument("squares of a checkerboard must have a positive size, have " +
                                std::to_string(settings_.size) + " m");
  }
  check_target(settings_.target);
  if (settings_.target.corners == CornerKind::pose &&
      turns_alike(settings_.points_x, settings_.points_y) < 4) {
    throw std::invalid_argument("a " + detail::board_text(settings_) +
                                " looks the same when rotated, so it has no pose of its own: take "
                                "its corners (CheckerboardFinder2d), or another board");
  }
}

Found CheckerboardFinder::find(const View& view) const {
  const std::string board = detail::board_text(settings_);
  if (const auto fault = detail::chessboard_fault(); !fault.empty()) {
    return refused(fault);
  }
  if (const auto fault = view_fault(view, settings_.target.corners); !fault.empty()) {
    return refused(fault);
  }
  if (detail::too_small_for(view.image, settings_)) {
    return refused("an image of " + detail::pixels_text(view.image.width, view.image.height) +
                   " pixels is too small for a " + board);
  }
  const detail::BoardsSeen search =
      detail::search_boards(view.image, settings_.points_x, settings_.points_y);
  if (search.boards.empty()) {
    return refused(search.larger ? "there is no " + board + ", only a part of a larger board"
                                 : "there is no " + board + ", or not all of it is to be seen");
  }
  std::vector<Eigen::Vector2d> corners = search.boards.front().corners;
  const double side = detail::smallest_side(search.boards.front());
  detail::refine_corners(view.image, detail::window_reach(side), corners);
  order_corners(view.image, settings_.points_x, settings_.points_y, corners);
  std::vector<TargetCorner> found;
  for (int i = 0; i < static_cast<int>(corners.size()); ++i) {
    const int column = i % settings_.points_x, row = i / settings_.points_x;
    const double x = column, y = row;
    found.push_back({i,
                     corners[static_cast<std::size_t>(i)],
                     {x * settings_.size, y * settings_.size, 0.0},
                     0.7 * side});
  }
  if (search.boards.size() > 1) {
    return refused("there are two " + board + ": which is meant?", marks_of(found));
  }
  if (const auto fault = quality_fault(view.image, corners); !fault.empty()) {
    return refused("the " + board + " is " + fault, marks_of(found));
  }
  return observed(view, settings_.target, std::move(found));
}

std::string CheckerboardFinder::quality_fault(const GrayImage& image,
                                              const std::vector<Eigen::Vector2d>& corners) const {
  const TargetQuality& quality = settings_.target.quality;
  const detail::CornerGrid grid{settings_.points_x, settings_.points_y, corners};
  const double side = detail::smallest_side(grid);
  if (side < quality.min_square) {
    return "too small: squares of " + detail::one_digit(side) + " pixels, at least " +
           detail::one_digit(quality.min_square) + " are needed";
  }
  if (detail::corners_at_border(image, corners, detail::window_reach(side) + 1.0)) {
    return "at the border of the image";
  }
  const double glare = detail::glare_share(image, grid);
  if (glare > quality.max_glare) {
    return "behind glare: " + detail::one_digit(100.0 * glare) +
           " % of its dark squares are saturated, at most " +
           detail::one_digit(100.0 * quality.max_glare) + " % may be";
  }
  return edge_fault(detail::edges_of(image, grid).edges, quality);
}

}  // namespace kinecal
