// Definitions of saddle_corner.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/saddle_corner.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kinecal/capture/boards/square_edges.hpp"

namespace kinecal::detail {

double saddle_contrast(const GrayImage& image, const Eigen::Vector2d& at, const CornerAxes& axes) {
  constexpr double kPlaces[4][2] = {{0.35, 0.35}, {0.85, 0.35}, {0.35, 0.85}, {0.85, 0.85}};
  const auto mean = [&](double x, double y) {
    double sum = 0.0;
    for (const auto& place : kPlaces) {
      sum += brightness_at(image, at + x * place[0] * axes.x + y * place[1] * axes.y);
    }
    return sum / 4.0;
  };
  return std::min(mean(1, -1), mean(-1, 1)) - std::max(mean(1, 1), mean(-1, -1));
}

namespace {

constexpr double kLeastSaddle = 12.0;  // of 255

[[nodiscard]] bool is_within(const GrayImage& image, const Eigen::Vector2d& p, double margin) {
  return p.x() >= margin && p.y() >= margin && p.x() <= image.width - 1 - margin &&
         p.y() <= image.height - 1 - margin;
}

/// The middle of the places with nearly the highest contrast, in steps of a quarter of the axes.
[[nodiscard]] std::optional<Eigen::Vector2d> roughly(const GrayImage& image,
                                                     const Eigen::Vector2d& near,
                                                     const CornerAxes& axes, double reach) {
  constexpr double kStep = 0.25, kNearly = 0.85;
  const int steps = std::max(1, static_cast<int>(std::lround(reach / kStep)));
  std::vector<std::pair<double, Eigen::Vector2d>> places;
  double best = kLeastSaddle;
  for (int i = -steps; i <= steps; ++i) {
    for (int j = -steps; j <= steps; ++j) {
      const Eigen::Vector2d at = near + kStep * (i * axes.x + j * axes.y);
      if (!is_within(image, at, 2.0)) continue;
      places.emplace_back(saddle_contrast(image, at, axes), at);
      best = std::max(best, places.back().first);
    }
  }
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (const auto& [contrast, at] : places) {
    if (contrast < kNearly * best || contrast <= kLeastSaddle) continue;
    sum += at;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

/// The image around a corner, smoothed: at the edges of a sharp image, squares of gradients in whole
/// pixels are off by a tenth of a pixel.
class SmoothPatch {
 public:
  /// @param passes  of the filter (1 2 1) / 4 in both directions
  SmoothPatch(const GrayImage& image, const Eigen::Vector2d& middle, int reach, int passes)
      : left_(static_cast<int>(std::lround(middle.x())) - reach),
        top_(static_cast<int>(std::lround(middle.y())) - reach),
        side_(2 * reach + 1) {
    values_.reserve(static_cast<std::size_t>(side_ * side_));
    for (int v = top_; v < top_ + side_; ++v) {
      for (int u = left_; u < left_ + side_; ++u) {
        values_.push_back(
            image(std::clamp(u, 0, image.width - 1), std::clamp(v, 0, image.height - 1)));
      }
    }
    for (int pass = 0; pass < passes; ++pass) {
      smooth(1, side_);
      smooth(side_, 1);
    }
  }

  /// The place where the gradients around a place meet.
  [[nodiscard]] std::optional<Eigen::Vector2d> meeting_point(const Eigen::Vector2d& near,
                                                             const CornerAxes& axes) const {
    Eigen::Matrix2d into, sums = Eigen::Matrix2d::Zero();
    into << axes.x, axes.y;
    if (!(std::abs(into.determinant()) > 1.0)) return std::nullopt;
    const Eigen::Matrix2d of_axes = into.inverse();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (int v = 1; v + 1 < side_; ++v) {
      for (int u = 1; u + 1 < side_; ++u) {
        const Eigen::Vector2d off = Eigen::Vector2d(left_ + u, top_ + v) - near;
        const Eigen::Vector2d place = of_axes * off;
        const double x = 1.0 - place.x() * place.x(), y = 1.0 - place.y() * place.y();
        if (x <= 0.0 || y <= 0.0) continue;
        const Eigen::Vector2d g(at(u + 1, v) - at(u - 1, v), at(u, v + 1) - at(u, v - 1));
        const Eigen::Matrix2d weighted = x * x * y * y * g * g.transpose();
        sums += weighted;
        right += weighted * off;
      }
    }
    if (!(sums.determinant() > 1e-6 * sums.trace() * sums.trace())) return std::nullopt;
    return near + sums.inverse() * right;
  }

 private:
  [[nodiscard]] double at(int u, int v) const {
    return values_[static_cast<std::size_t>(v * side_ + u)];
  }
  /// Along lines of pixels that are `step` apart.
  void smooth(int step, int next) {
    for (int line = 0; line < side_; ++line) {
      double before = values_[static_cast<std::size_t>(line * next)];
      for (int i = 1; i + 1 < side_; ++i) {
        double& value = values_[static_cast<std::size_t>(line * next + i * step)];
        const double after = values_[static_cast<std::size_t>(line * next + (i + 1) * step)];
        const double smoothed = 0.25 * (before + after) + 0.5 * value;
        before = value;
        value = smoothed;
      }
    }
  }

  int left_, top_, side_;
  std::vector<double> values_ = {};
};

/// The saddle from a first place, at most `most` pixels from it.
[[nodiscard]] std::optional<Eigen::Vector2d> exactly(const GrayImage& image,
                                                     const Eigen::Vector2d& first,
                                                     const CornerAxes& axes, double most) {
  constexpr int kPasses = 10;
  constexpr double kStill = 0.002, kWide = 5.0;  // pixels
  const double across = std::abs(axes.x.x() * axes.y.y() - axes.x.y() * axes.y.x()) /
                        std::max(axes.x.norm(), axes.y.norm());
  const double reach = std::max(axes.x.norm(), axes.y.norm()) * std::sqrt(2.0) + 2.0;
  const SmoothPatch patch(image, first, static_cast<int>(std::ceil(reach + 0.5 * most)),
                          across < kWide ? 1 : 2);
  Eigen::Vector2d at = first;
  for (int pass = 0; pass < kPasses; ++pass) {
    const auto next = patch.meeting_point(at, axes);
    if (!next || !is_within(image, *next, 2.0) || (*next - first).norm() > most)
      return std::nullopt;
    const double moved = (*next - at).norm();
    at = *next;
    if (moved < kStill) break;
  }
  return at;
}

}  // namespace

std::optional<Eigen::Vector2d> find_saddle(const GrayImage& image, const Eigen::Vector2d& near,
                                           const CornerAxes& axes, double reach) {
  constexpr double kLargest = 12.0;  // pixels
  const double longest = std::max(axes.x.norm(), axes.y.norm());
  if (!(longest >= 1.0)) return std::nullopt;
  const auto first = roughly(image, near, axes, reach);
  if (!first) return std::nullopt;
  const double share = std::min(1.0, kLargest / longest);
  const auto at = exactly(image, *first, {share * axes.x, share * axes.y}, longest);
  if (!at || saddle_contrast(image, *at, axes) <= kLeastSaddle) return std::nullopt;
  return at;
}

}  // namespace kinecal::detail
