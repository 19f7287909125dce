// Definitions of charuco_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/charuco_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/boards/board_fit.hpp"
#include "kinecal/capture/boards/homography.hpp"
#include "kinecal/capture/boards/opencv_corners.hpp"

namespace kinecal {

namespace detail {
namespace {

// Where the markers of a ChArUco board are, and whether a view contradicts it.

/// Column and row.
using SquarePlace = std::pair<int, int>;

/// The squares with markers, in the order of their ids: row by row from the top left.
[[nodiscard]] std::vector<SquarePlace> marker_places(const CharucoSettings& s) {
  const int white = s.legacy && s.squares_y % 2 == 0 ? 0 : 1;
  std::vector<SquarePlace> places;
  for (int row = 0; row < s.squares_y; ++row) {
    for (int column = 0; column < s.squares_x; ++column) {
      if ((column + row) % 2 == white) places.emplace_back(column, row);
    }
  }
  return places;
}

/// The corners of markers where a board of some layout has them, in squares.
[[nodiscard]] std::vector<TargetCorner> marker_corners(const std::map<SquarePlace, Marker>& markers,
                                                       const CharucoSettings& layout) {
  CharucoSettings board = layout;
  board.squares_y += 100;  // as many rows as it takes, odd or even as before
  const std::vector<SquarePlace> places = marker_places(board);
  const double gap = 0.5 * (1.0 - board.marker_size / board.square_size);
  std::vector<TargetCorner> corners;
  for (const auto& [unused, marker] : markers) {
    const int number = marker.id - board.first_id;
    if (number < 0 || number >= static_cast<int>(places.size())) return {};
    const auto& [column, row] = places[static_cast<std::size_t>(number)];
    for (std::size_t k = 0; k < 4; ++k) {
      const double x = k == 1 || k == 2 ? 1.0 - gap : gap, y = k >= 2 ? 1.0 - gap : gap;
      TargetCorner corner;
      corner.id = 4 * number + static_cast<int>(k);
      corner.pixel = marker.corners[k];
      corner.target = {column + x, row + y, 0.0};
      corners.push_back(corner);
    }
  }
  return corners;
}

/// The share of markers' corners that a layout has in the wrong place; one if most are.
[[nodiscard]] double wrong_share(const std::map<SquarePlace, Marker>& markers,
                                 const CharucoSettings& layout, const CameraInfo& camera) {
  const BoardFit fit = fit_board(marker_corners(markers, layout), camera);
  if (fit.off.empty() || !fit.agrees()) return 1.0;
  return fit.wrong() / static_cast<double>(fit.off.size());
}

/// Why the settings of a board contradict its markers, with those that agree; empty if they do not,
/// or if no others do.
[[nodiscard]] std::string charuco_layout_fault(const std::map<SquarePlace, Marker>& markers,
                                               const CharucoSettings& settings,
                                               const CameraInfo& camera) {
  constexpr std::size_t kEnough = 4;  // markers: of two rows, as a rule
  constexpr double kContradicts = 0.15, kAgrees = 0.05;
  constexpr int kMost = 30;
  if (markers.size() < kEnough || wrong_share(markers, settings, camera) <= kContradicts) return "";
  std::vector<CharucoSettings> others;
  for (int columns = 3; columns <= kMost; ++columns) {
    for (const bool legacy : {false, true}) {
      CharucoSettings other = settings;
      other.squares_x = columns;
      other.legacy = legacy;
      if (legacy != settings.legacy && settings.squares_y % 2 == 1) continue;  // the same
      if (wrong_share(markers, other, camera) <= kAgrees) others.push_back(other);
    }
  }
  if (others.size() != 1) return "";
  const CharucoSettings& right = others.front();
  std::string keys;
  if (right.squares_x != settings.squares_x) {
    keys = "squares_x: " + std::to_string(right.squares_x);
  }
  if (right.legacy != settings.legacy) {
    keys +=
        (keys.empty() ? "legacy: " : ", legacy: ") + std::string(right.legacy ? "true" : "false");
  }
  return "the markers are not where a board of " + std::to_string(settings.squares_x) +
         " squares in a row has them; write " + keys;
}

/// Markers of a board by their places; `twice` gets the id of one that occurs twice.
[[nodiscard]] std::map<SquarePlace, Marker> markers_by_place(const std::vector<Marker>& markers,
                                                             const CharucoSettings& s, int& twice) {
  const std::vector<SquarePlace> places = marker_places(s);
  std::map<SquarePlace, Marker> found;
  for (const Marker& m : markers) {
    const int number = m.id - s.first_id;
    if (number < 0 || number >= static_cast<int>(places.size())) continue;
    if (!found.emplace(places[static_cast<std::size_t>(number)], m).second) twice = m.id;
  }
  return found;
}

/// The position of a corner between two markers, by the map of their corners; nullopt if one is
/// missing.
[[nodiscard]] std::optional<Eigen::Vector2d> between_markers(
    const std::map<SquarePlace, Marker>& markers, const CharucoSettings& s, int column, int row) {
  std::vector<Eigen::Vector2d> from, to;
  const double gap = (1.0 - s.marker_size / s.square_size) / 2.0;
  for (int k = 0; k < 4; ++k) {
    const SquarePlace place = {column + k % 2, row + k / 2};
    const auto marker = markers.find(place);
    if (marker == markers.end()) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      const double x = i == 1 || i == 2 ? 1.0 - gap : gap, y = i >= 2 ? 1.0 - gap : gap;
      from.emplace_back(place.first + x, place.second + y);
      to.push_back(marker->second.corners[i]);
    }
  }
  if (from.size() < 8) return std::nullopt;
  const auto h = homography(from, to);
  if (!h) return std::nullopt;
  return mapped(*h, Eigen::Vector2d(column + 1.0, row + 1.0));
}

/// Corners by column and row.
using CornerMap = std::map<SquarePlace, Eigen::Vector2d>;

/// Calls f(a, b, direction) for each pair of neighbours; 0 is along rows.
template <class F>
void for_each_pair(const CornerMap& corners, const F& f) {
  for (const auto& [place, at] : corners) {
    const auto right = corners.find({place.first + 1, place.second}),
               below = corners.find({place.first, place.second + 1});
    if (right != corners.end()) f(at, right->second, std::size_t{0});
    if (below != corners.end()) f(at, below->second, std::size_t{1});
  }
}

/// The shortest side of a square between two corners, pixels; infinite if absent.
[[nodiscard]] double shortest_of(const CornerMap& corners) {
  double least = std::numeric_limits<double>::infinity();
  for_each_pair(corners, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::size_t) {
    least = std::min(least, (b - a).norm());
  });
  return least;
}

/// Refined corners between markers; drops those that move further than the gap to a marker.
[[nodiscard]] CornerMap charuco_corners(const GrayImage& image,
                                        const std::map<SquarePlace, Marker>& markers,
                                        const CharucoSettings& s) {
  CornerMap corners;
  for (int row = 0; row + 1 < s.squares_y; ++row) {
    for (int column = 0; column + 1 < s.squares_x; ++column) {
      const auto at = between_markers(markers, s, column, row);
      if (at) corners.emplace(SquarePlace{column, row}, *at);
    }
  }
  const double side = shortest_of(corners);
  if (!std::isfinite(side)) return corners;
  const double gap = side * (1.0 - s.marker_size / s.square_size) / 2.0;
  const int reach = std::clamp(static_cast<int>(gap), 2, 12);
  for (auto c = corners.begin(); c != corners.end();) {
    std::vector<Eigen::Vector2d> refined = {c->second};
    refine_corners(image, reach, refined);
    const bool near = (refined[0] - c->second).norm() <= reach;
    c->second = refined[0];
    c = near ? std::next(c) : corners.erase(c);
  }
  return corners;
}

/// Why the corners are too few or too poor; empty if they are not.
[[nodiscard]] std::string charuco_fault(const GrayImage& image, const CornerMap& corners,
                                        const CharucoSettings& s) {
  std::set<int> columns, rows;
  for (const auto& corner : corners) {
    columns.insert(corner.first.first);
    rows.insert(corner.first.second);
  }
  const int all = (s.squares_x - 1) * (s.squares_y - 1);
  if (static_cast<int>(corners.size()) < s.min_corners || columns.size() < 2 || rows.size() < 2) {
    return "seen at " + std::to_string(corners.size()) + " of " + std::to_string(all) +
           " corners; at least " + std::to_string(s.min_corners) +
           " must be, in two rows and two columns";
  }
  const double side = shortest_of(corners);
  if (side < s.target.quality.min_square) {
    return "too small: squares of " + one_digit(side) + " pixels, at least " +
           one_digit(s.target.quality.min_square) + " are needed";
  }
  const double gap = side * (1.0 - s.marker_size / s.square_size) / 2.0;
  std::vector<EdgeMeasure> edges[2];
  for_each_pair(corners, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::size_t way) {
    if (const auto edge = measure_edge(image, a, b, std::max(2.0, gap)))
      edges[way].push_back(*edge);
  });
  return edge_fault(edges, s.target.quality);
}

}  // namespace
}  // namespace detail

CharucoFinder::CharucoFinder(CharucoSettings settings) : settings_(std::move(settings)) {
  const CharucoSettings& s = settings_;
  if (s.squares_x < 3 || s.squares_y < 3 || s.min_corners < 4 || s.first_id < 0) {
    throw std::invalid_argument(
        "a ChArUco board needs at least 3 x 3 squares, min_corners >= 4 and first_id >= 0");
  }
  if (!(s.marker_size > 0.0) || !(s.square_size > s.marker_size)) {
    throw std::invalid_argument("markers of a ChArUco board must be smaller than its squares: " +
                                std::to_string(s.marker_size) + " m in " +
                                std::to_string(s.square_size) + " m");
  }
  const auto& names = detail::marker_dictionaries();
  if (std::find(names.begin(), names.end(), s.dictionary) == names.end()) {
    std::string known;
    for (const auto& name : names) known += (known.empty() ? "" : ", ") + name;
    throw std::invalid_argument("there is no dictionary '" + s.dictionary + "', only " + known);
  }
  check_target(s.target);
}

Found CharucoFinder::find(const View& view) const {
  if (const auto fault = detail::aruco_fault(); !fault.empty()) {
    return refused(fault);
  }
  if (const auto fault = view_fault(view, settings_.target.corners); !fault.empty()) {
    return refused(fault);
  }
  int twice = -1;
  const auto markers = detail::markers_by_place(
      detail::find_markers(view.image, settings_.dictionary), settings_, twice);
  if (twice >= 0) {
    return refused("marker " + std::to_string(twice) + " is seen twice: which is meant?");
  }
  if (const auto fault = detail::charuco_layout_fault(markers, settings_, *view.camera);
      !fault.empty()) {
    return refused(fault);
  }
  const detail::CornerMap corners = detail::charuco_corners(view.image, markers, settings_);
  const double side = detail::shortest_of(corners), square = settings_.square_size;
  std::vector<TargetCorner> found;
  for (const auto& [place, at] : corners) {
    found.push_back({place.second * (settings_.squares_x - 1) + place.first,
                     at,
                     {(place.first + 1) * square, (place.second + 1) * square, 0.0},
                     0.7 * side});
  }
  const std::string fault = detail::charuco_fault(view.image, corners, settings_);
  if (!fault.empty()) return refused("the ChArUco board is " + fault, marks_of(found));
  return observed(view, settings_.target, std::move(found));
}

}  // namespace kinecal
