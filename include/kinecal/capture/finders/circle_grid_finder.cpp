// Definitions of circle_grid_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/circle_grid_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "kinecal/capture/boards/disc_centres.hpp"
#include "kinecal/capture/boards/opencv_corners.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The place of each disc on its grid, metres.
[[nodiscard]] std::vector<Eigen::Vector2d> disc_places(const CircleGridSettings& s) {
  std::vector<Eigen::Vector2d> places;
  for (int row = 0; row < s.points_y; ++row) {
    for (int column = 0; column < s.points_x; ++column) {
      const int x = s.asymmetric ? 2 * column + row % 2 : column;
      places.emplace_back(x * s.size, row * s.size);
    }
  }
  return places;
}

/// "grid of 4 x 11 discs"
[[nodiscard]] std::string circles_text(const CircleGridSettings& s) {
  return "grid of " + std::to_string(s.points_x) + " x " + std::to_string(s.points_y) + " discs";
}

/// Discs in one of the orders in which they may be the grid's: rows or columns reversed, or exchanged.
[[nodiscard]] std::vector<Eigen::Vector2d> reordered(const std::vector<Eigen::Vector2d>& found,
                                                     const CircleGridSettings& s, int order) {
  std::vector<Eigen::Vector2d> discs;
  for (int row = 0; row < s.points_y; ++row) {
    for (int column = 0; column < s.points_x; ++column) {
      int x = column, y = row;
      if ((order & 4) != 0) std::swap(x, y);
      if ((order & 1) != 0) x = s.points_x - 1 - x;
      if ((order & 2) != 0) y = s.points_y - 1 - y;
      const int place = y * s.points_x + x;
      discs.push_back(found[static_cast<std::size_t>(place)]);
    }
  }
  return discs;
}

/// True if each disc is about midway between those on opposite sides of it, whatever a lens bends.
[[nodiscard]] bool is_disc_grid(const std::vector<Eigen::Vector2d>& discs,
                                const CircleGridSettings& s) {
  constexpr double kMostOff = 0.2;  // of the step: a lens bends less, another order is a step off
  constexpr std::pair<int, int> kWays[] = {{1, 0}, {0, 1}, {1, 1}, {1, -1}, {2, 0}};
  const auto steps = [&](const Eigen::Vector2d& place) {
    return std::pair(std::lround(place.x() / s.size), std::lround(place.y() / s.size));
  };
  std::map<std::pair<long, long>, Eigen::Vector2d> at;
  const std::vector<Eigen::Vector2d> places = disc_places(s);
  for (std::size_t i = 0; i < places.size(); ++i) at[steps(places[i])] = discs[i];
  for (const auto& [place, disc] : at) {
    for (const auto& [x, y] : kWays) {
      const auto before = at.find({place.first - x, place.second - y}),
                 after = at.find({place.first + x, place.second + y});
      if (before == at.end() || after == at.end()) continue;
      const Eigen::Vector2d off = 0.5 * (before->second + after->second) - disc;
      if (off.norm() > kMostOff * 0.5 * (after->second - before->second).norm()) return false;
    }
  }
  return true;
}

/// Discs in the grid's order: seen from its front, where they lie as the grid says; x to the right if
/// there is a choice.  Empty if no order does.
[[nodiscard]] std::vector<Eigen::Vector2d> ordered_discs(const std::vector<Eigen::Vector2d>& found,
                                                         const CircleGridSettings& s) {
  const auto across = static_cast<std::size_t>(s.points_x - 1),
             down = static_cast<std::size_t>(s.points_x * (s.points_y - 1));
  std::vector<Eigen::Vector2d> best;
  double most = -std::numeric_limits<double>::infinity();
  const int orders = !s.asymmetric && s.points_x == s.points_y ? 8 : 4;
  for (int order = 0; order < orders; ++order) {
    std::vector<Eigen::Vector2d> discs = reordered(found, s, order);
    const Eigen::Vector2d x = discs[across] - discs.front(), y = discs[down] - discs.front();
    if (x.x() * y.y() - x.y() * y.x() <= 0.0) continue;  // mirrored
    if (!is_disc_grid(discs, s)) continue;
    if (const double right = x.x() / x.norm(); right > most) {
      most = right;
      best = std::move(discs);
    }
  }
  return best;
}

/// An image in which dark is bright.
[[nodiscard]] GrayImage negative(GrayImage image) {
  for (std::uint8_t& p : image.pixels) p = static_cast<std::uint8_t>(255 - p);
  return image;
}

/// Why discs are too small, at the border or not sharp; empty if they are not.
[[nodiscard]] std::string discs_fault(const GrayImage& image, const DiscCentres& discs,
                                      const std::vector<Eigen::Vector2d>& places,
                                      const TargetQuality& quality) {
  double least = std::numeric_limits<double>::infinity();
  std::vector<EdgeMeasure> edges[2];
  const double r = discs.radius;
  for (const Eigen::Vector2d& place : places) {
    for (int way = 0; way < 4; ++way) {
      const double sign = way < 2 ? 1.0 : -1.0;
      const Eigen::Vector2d out =
          sign * (way % 2 == 0 ? Eigen::Vector2d(r, 0.0) : Eigen::Vector2d(0.0, r));
      const Eigen::Vector2d along(-0.4 * out.y(), 0.4 * out.x());
      const Eigen::Vector2d a = discs.image(place + out - along),
                            b = discs.image(place + out + along);
      const double wide = (discs.image(place + out) - discs.image(place)).norm();
      least = std::min(least, 2.0 * wide);
      if (const auto edge = measure_edge(image, a, b, 0.7 * wide)) {
        edges[way % 2].push_back(*edge);
      }
    }
  }
  if (least < quality.min_square) {
    return "too small: discs of " + one_digit(least) + " pixels, at least " +
           one_digit(quality.min_square) + " are needed";
  }
  return edge_fault(edges, quality);
}

}  // namespace
}  // namespace detail

int turns_alike(const CircleGridSettings& grid) {
  if (grid.asymmetric) return grid.points_y % 2 == 0 ? 2 : 4;
  return grid.points_x == grid.points_y ? 1 : 2;
}

CircleGridFinder::CircleGridFinder(CircleGridSettings settings) : settings_(std::move(settings)) {
  const std::string grid = "a " + detail::circles_text(settings_);
  if (settings_.points_x < 2 || settings_.points_y < 2) {
    throw std::invalid_argument(grid + ": it needs at least 2 x 2");
  }
  if (!(settings_.size > 0.0)) {
    throw std::invalid_argument("discs of a grid must have a positive distance, have " +
                                std::to_string(settings_.size) + " m");
  }
  check_target(settings_.target);
  if (settings_.target.corners == CornerKind::pose && turns_alike(settings_) < 4) {
    throw std::invalid_argument(
        grid +
        " looks the same when rotated, so it has no pose of its own: take its "
        "centres (CircleGridFinder2d), or an asymmetric grid with an odd "
        "number of rows");
  }
}

Found CircleGridFinder::find(const View& view) const {
  if (const auto fault = detail::circles_fault(); !fault.empty()) return refused(fault);
  if (const auto fault = view_fault(view, settings_.target.corners); !fault.empty()) {
    return refused(fault);
  }
  const std::string grid = detail::circles_text(settings_);
  const std::vector<Eigen::Vector2d> places = detail::disc_places(settings_);
  // Of white discs on black, the negative is searched.
  GrayImage image = view.image;
  std::vector<Eigen::Vector2d> about;
  for (const bool white : {false, true}) {
    if (white) image = detail::negative(view.image);
    about =
        detail::find_circles(image, settings_.points_x, settings_.points_y, settings_.asymmetric);
    if (!about.empty()) about = detail::ordered_discs(about, settings_);
    if (!about.empty()) break;
  }
  if (about.empty()) return refused("there is no " + grid + ", or not all of it is to be seen");
  const double gap = settings_.size * (settings_.asymmetric ? std::sqrt(2.0) : 1.0);
  const auto discs = disc_centres(image, places, about, gap, *view.camera);
  if (!discs) {
    return refused("the discs of the " + grid +
                   " are not clearly black on white or white on black");
  }
  std::vector<TargetCorner> found;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double reach = 0.7 * (discs->image(places[i] + Eigen::Vector2d(discs->radius, 0)) -
                                discs->image(places[i]))
                                   .norm();
    found.push_back(
        {static_cast<int>(i), discs->pixels[i], {places[i].x(), places[i].y(), 0.0}, reach});
  }
  const std::string fault = detail::discs_fault(image, *discs, places, settings_.target.quality);
  if (!fault.empty()) return refused("the " + grid + " is " + fault, marks_of(found));
  return observed(view, settings_.target, std::move(found));
}

}  // namespace kinecal
