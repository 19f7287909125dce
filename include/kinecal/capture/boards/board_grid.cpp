// Definitions of board_grid.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/board_grid.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace kinecal {

namespace detail {
namespace {

/// The nearest corner along an axis of the target, 0 or 1, and on the same line; nullopt if absent.
[[nodiscard]] std::optional<std::size_t> next_along(const std::vector<TargetCorner>& corners,
                                                    std::size_t from, Eigen::Index axis) {
  constexpr double kStraight = 0.02;  // of the way
  std::optional<std::size_t> next;
  double least = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3<double> way = corners[i].target - corners[from].target;
    const double along = way(axis), across = way(1 - axis);
    if (!(along > 0.0) || std::abs(across) > kStraight * along) continue;
    if (next && along >= least) continue;
    next = i;
    least = along;
  }
  return next;
}

}  // namespace
}  // namespace detail

std::vector<GridLine> board_grid(const std::vector<TargetCorner>& corners, const BoardFit& fit) {
  std::vector<GridLine> lines;
  if (fit.fitted.size() != corners.size()) return lines;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (const Eigen::Index axis : {0, 1}) {
      const auto next = detail::next_along(corners, i, axis);
      if (!next) continue;
      const Eigen::Vector2d &a = fit.fitted[i], &b = fit.fitted[*next];
      if (a.allFinite() && b.allFinite()) lines.push_back({a.x(), a.y(), b.x(), b.y()});
    }
  }
  return lines;
}

}  // namespace kinecal
