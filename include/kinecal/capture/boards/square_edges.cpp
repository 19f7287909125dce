// Definitions of square_edges.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/square_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "kinecal/geometry/median.hpp"

namespace kinecal {

namespace detail {

inline constexpr double kEdgeStep = 0.5;      // pixels
inline constexpr double kLeastContrast = 15;  // of 255

std::string one_digit(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", value);
  return text.data();
}

/// The brightness across an edge from -reach to reach, averaged along its middle 40 %.
[[nodiscard]] std::vector<double> edge_profile(const GrayImage& image, const Eigen::Vector2d& a,
                                               const Eigen::Vector2d& b, double reach) {
  const Eigen::Vector2d along = b - a;
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
  const int half = std::max(3, static_cast<int>(reach / kEdgeStep));
  const int lines = std::clamp(static_cast<int>(0.4 * along.norm()), 5, 15);
  std::vector<double> profile;
  for (int k = -half; k <= half; ++k) {
    double sum = 0.0;
    for (int i = 0; i < lines; ++i) {
      const double t = 0.3 + 0.4 * i / (lines - 1);
      sum += brightness_at(image, a + t * along + k * kEdgeStep * across);
    }
    profile.push_back(sum / lines);
  }
  return profile;
}

}  // namespace detail

double brightness_at(const GrayImage& image, const Eigen::Vector2d& pixel) {
  const double u = std::clamp(pixel.x(), 0.0, image.width - 1.0);
  const double v = std::clamp(pixel.y(), 0.0, image.height - 1.0);
  const int left = static_cast<int>(u), top = static_cast<int>(v);
  const int right = std::min(left + 1, image.width - 1), low = std::min(top + 1, image.height - 1);
  const double s = u - left, t = v - top;
  return (1.0 - t) * ((1.0 - s) * image(left, top) + s * image(right, top)) +
         t * ((1.0 - s) * image(left, low) + s * image(right, low));
}

std::optional<EdgeMeasure> measure_edge(const GrayImage& image, const Eigen::Vector2d& a,
                                        const Eigen::Vector2d& b, double reach) {
  std::vector<double> profile = detail::edge_profile(image, a, b, reach);
  const std::size_t n = profile.size();
  if (profile.front() > profile.back()) std::reverse(profile.begin(), profile.end());
  EdgeMeasure edge;
  edge.dark = (profile[0] + profile[1]) / 2.0;
  edge.contrast = (profile[n - 1] + profile[n - 2]) / 2.0 - edge.dark;
  if (edge.contrast < detail::kLeastContrast) return std::nullopt;
  double steepest = 0.0;
  for (std::size_t k = 1; k + 1 < n; ++k) {
    steepest = std::max(steepest, (profile[k + 1] - profile[k - 1]) / (2.0 * detail::kEdgeStep));
  }
  edge.width = edge.contrast / steepest;
  edge.length = (b - a).norm();
  const double middle = edge.dark + edge.contrast / 2.0;
  std::size_t k = 1;
  while (k + 1 < n && profile[k] < middle) ++k;
  const double rise = std::max(profile[k] - profile[k - 1], 1e-9);
  const double at = static_cast<double>(k) - (profile[k] - middle) / rise;
  edge.bleed = (static_cast<double>(n - 1) / 2.0 - at) * detail::kEdgeStep;
  return edge;
}

std::string edge_fault(const std::vector<EdgeMeasure> (&edges)[2], const TargetQuality& quality) {
  constexpr double kWidthOfLength = 0.03, kBleedOfLength = 0.01;
  for (const auto& direction : edges) {
    if (direction.empty()) return "there is no contrast between its squares";
  }
  const auto worst = [&](double EdgeMeasure::*value) {
    double most = 0.0;
    for (const auto& direction : edges) {
      std::vector<double> values;
      for (const EdgeMeasure& e : direction) values.push_back(e.*value);
      most = std::max(most, median_of(std::move(values)));
    }
    return most;
  };
  const double length = worst(&EdgeMeasure::length), width = worst(&EdgeMeasure::width),
               bleed = worst(&EdgeMeasure::bleed);
  const double max_width = std::max(quality.max_edge_width, kWidthOfLength * length),
               max_bleed = std::max(quality.max_bleed, kBleedOfLength * length);
  if (width > max_width) {
    return "blurred: edges are " + detail::one_digit(width) + " pixels wide, at most " +
           detail::one_digit(max_width) + " are allowed; is the robot still moving?";
  }
  if (bleed > max_bleed) {
    return "over-exposed: white bleeds " + detail::one_digit(bleed) +
           " pixels into the dark squares, at most " + detail::one_digit(max_bleed) +
           " are allowed; expose for a shorter time";
  }
  return "";
}

}  // namespace kinecal
