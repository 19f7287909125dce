// Definitions of saddle_corner.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/saddle_corner.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "kinecal/capture/square_edges.hpp"

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

/// Where the gradients around a place meet.
[[nodiscard]] std::optional<Eigen::Vector2d> meeting_point(const GrayImage& image,
                                                           const Eigen::Vector2d& near,
                                                           const CornerAxes& axes) {
  constexpr double kWindow = 0.8;  // of the axes
  const double longest = std::max(axes.x.norm(), axes.y.norm());
  const int steps = std::clamp(static_cast<int>(std::lround(kWindow * longest)), 3, 8);
  Eigen::Matrix2d sums = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  const Eigen::Vector2d u(1.0, 0.0), v(0.0, 1.0);
  for (int i = -steps; i <= steps; ++i) {
    for (int j = -steps; j <= steps; ++j) {
      const double x = static_cast<double>(i) / steps, y = static_cast<double>(j) / steps;
      const Eigen::Vector2d off = kWindow * (x * axes.x + y * axes.y), at = near + off;
      const Eigen::Vector2d g(brightness_at(image, at + u) - brightness_at(image, at - u),
                              brightness_at(image, at + v) - brightness_at(image, at - v));
      const Eigen::Matrix2d weighted = std::exp(-2.0 * (x * x + y * y)) * g * g.transpose();
      sums += weighted;
      right += weighted * off;
    }
  }
  if (!(sums.determinant() > 1e-6 * sums.trace() * sums.trace())) return std::nullopt;
  return near + sums.inverse() * right;
}

}  // namespace

std::optional<Eigen::Vector2d> find_saddle(const GrayImage& image, const Eigen::Vector2d& near,
                                           const CornerAxes& axes, double reach) {
  constexpr int kPasses = 8;
  constexpr double kStill = 0.005, kLargest = 12.0;  // pixels
  const double longest = std::max(axes.x.norm(), axes.y.norm());
  if (!(longest >= 1.0)) return std::nullopt;
  const auto first = roughly(image, near, axes, reach);
  if (!first) return std::nullopt;
  const double share = std::min(1.0, kLargest / longest);
  const CornerAxes window{share * axes.x, share * axes.y};
  Eigen::Vector2d at = *first;
  for (int pass = 0; pass < kPasses; ++pass) {
    const auto next = meeting_point(image, at, window);
    if (!next || !is_within(image, *next, 2.0)) return std::nullopt;
    const double moved = (*next - at).norm();
    at = *next;
    if ((at - *first).norm() > longest) return std::nullopt;
    if (moved < kStill) break;
  }
  if (saddle_contrast(image, at, axes) <= kLeastSaddle) return std::nullopt;
  return at;
}

}  // namespace kinecal::detail
