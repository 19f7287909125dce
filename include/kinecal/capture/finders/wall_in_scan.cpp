// Fitting the line of a wall.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/wall_in_scan.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <vector>

namespace kinecal {

namespace detail {
namespace {

using Points = std::vector<Eigen::Vector2d>;

/// A line: normal . p = distance.
struct Line {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();
  double distance = 0.0;  ///< metres, not negative

  [[nodiscard]] double off(const Eigen::Vector2d& p) const { return normal.dot(p) - distance; }
};

[[nodiscard]] Line away_from_scanner(Line line) {
  if (line.distance < 0.0) line = {-line.normal, -line.distance};
  return line;
}

[[nodiscard]] Line through(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = (b - a).normalized(), normal(-along.y(), along.x());
  return away_from_scanner({normal, normal.dot(a)});
}

/// The line with the least squares of distances.
[[nodiscard]] Line fitted(const Points& points) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& p : points) scatter += (p - mean) * (p - mean).transpose();
  const double angle = 0.5 * std::atan2(2.0 * scatter(0, 1), scatter(0, 0) - scatter(1, 1));
  const Eigen::Vector2d normal(-std::sin(angle), std::cos(angle));
  return away_from_scanner({normal, normal.dot(mean)});
}

[[nodiscard]] Points near(const Line& line, const Points& points, double within) {
  Points all;
  std::copy_if(points.begin(), points.end(), std::back_inserter(all),
               [&](const Eigen::Vector2d& p) { return std::abs(line.off(p)) <= within; });
  return all;
}

/// The line through two of the points that has most points near it.
[[nodiscard]] Line most_crowded(const Points& points, double within) {
  constexpr std::size_t kTried = 40;  // of the points, spread evenly
  const std::size_t step = std::max<std::size_t>(1, points.size() / kTried);
  Line best;
  std::size_t most = 0;
  for (std::size_t a = 0; a < points.size(); a += step) {
    for (std::size_t b = a + step; b < points.size(); b += step) {
      if ((points[b] - points[a]).norm() < 5.0 * within) continue;
      const Line line = through(points[a], points[b]);
      const auto count = static_cast<std::size_t>(
          std::count_if(points.begin(), points.end(),
                        [&](const Eigen::Vector2d& p) { return std::abs(line.off(p)) <= within; }));
      if (count > most) most = count, best = line;
    }
  }
  return best;
}

/// Points in the window, in the frame of the scanner.
[[nodiscard]] Points points_of(const ScanRanges& scan, const WallWindow& window) {
  const double middle = 0.5 * (window.min_angle + window.max_angle),
               half = 0.5 * (window.max_angle - window.min_angle);
  Points points;
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double angle = scan.angle(i), range = scan.ranges[i];
    const bool is_within = std::abs(std::remainder(angle - middle, 2.0 * std::numbers::pi)) <= half;
    if (is_within && scan.counts(i)) {
      points.emplace_back(range * std::cos(angle), range * std::sin(angle));
    }
  }
  return points;
}

/// How far the middle of points stands out of the line of their ends, metres.
/// @param along  place of each on the line, from its middle
[[nodiscard]] double bow(const Line& line, const Points& points, const std::vector<double>& along) {
  double mean = 0.0, product = 0.0, square = 0.0, farthest = 0.0;
  for (const double s : along) mean += s * s / static_cast<double>(along.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double of = along[i] * along[i] - mean;
    product += of * line.off(points[i]);
    square += of * of;
    farthest = std::max(farthest, std::abs(along[i]));
  }
  return square > 0.0 ? std::abs(product / square) * farthest * farthest : 0.0;
}

template <class... Numbers>
[[nodiscard]] FoundWall no_wall(const char* format, Numbers... numbers) {
  char text[200];
  (void)std::snprintf(text, sizeof text, format, numbers...);
  return {{}, text};
}

}  // namespace
}  // namespace detail

FoundWall wall_in_scan(const ScanRanges& scan, const WallWindow& window) {
  constexpr std::size_t kFewest = 10;
  constexpr int kRounds = 3;
  const detail::Points points = detail::points_of(scan, window);
  if (points.size() < kFewest) {
    return detail::no_wall("%zu ranges between %.2f and %.2f rad are numbers, a wall takes %zu",
                           points.size(), window.min_angle, window.max_angle, kFewest);
  }
  detail::Line line = detail::most_crowded(points, window.thickness);
  detail::Points on = detail::near(line, points, window.thickness);
  for (int round = 0; round < kRounds && on.size() >= 2; ++round) {
    line = detail::fitted(on);
    on = detail::near(line, points, window.thickness);
  }
  const auto count = static_cast<double>(on.size());
  const double share = count / static_cast<double>(points.size());
  if (on.size() < kFewest || share < window.least_share) {
    return detail::no_wall("%.0f %% of %zu points are on one line, of a wall %.0f %% would be",
                           100.0 * share, points.size(), 100.0 * window.least_share);
  }
  double squares = 0.0, length = 0.0, mean = 0.0;
  const Eigen::Vector2d direction(-line.normal.y(), line.normal.x());
  std::vector<double> along;
  for (const Eigen::Vector2d& p : on) mean += direction.dot(p) / count;
  for (const Eigen::Vector2d& p : on) {
    along.push_back(direction.dot(p) - mean);
    squares += line.off(p) * line.off(p);
    length += along.back() * along.back();
  }
  const double scatter = std::sqrt(squares / (count - 2.0)), known = scatter / std::sqrt(length);
  if (!(known <= window.angle_known)) {
    return detail::no_wall("its angle is known to %.1f deg only: %zu points on a line of %.2f m",
                           known * 180.0 / std::numbers::pi, on.size(),
                           std::sqrt(12.0 * length / count));
  }
  const double bent = detail::bow(line, on, along);
  if (bent > 0.5 * window.thickness) {
    return detail::no_wall("its points are not on a line: the middle stands out by %.0f mm",
                           1000.0 * bent);
  }
  return {ScanWall{std::atan2(line.normal.y(), line.normal.x()), line.distance, scatter,
                   static_cast<int>(on.size())},
          ""};
}

}  // namespace kinecal
