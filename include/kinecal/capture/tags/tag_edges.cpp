// Definitions of tag_edges.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/tags/tag_edges.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "kinecal/capture/boards/square_edges.hpp"

namespace kinecal::detail {

/// The offset along the normal at which the brightness is halfway, at t from a to b, pixels.
[[nodiscard]] std::optional<double> edge_offset(const GrayImage& image, const Eigen::Vector2d& at,
                                                const Eigen::Vector2d& normal, double reach) {
  constexpr double kStep = 0.25;
  const int half = static_cast<int>(reach / kStep);
  const auto value = [&](int k) { return brightness_at(image, at + k * kStep * normal); };
  const double low = value(-half), high = value(half), middle = (low + high) / 2.0;
  if (std::abs(high - low) < 15.0) return std::nullopt;
  for (int k = 0; k < 2 * half; ++k) {  // from the middle outwards, alternating sides
    const int i = k % 2 == 0 ? k / 2 : -(k / 2) - 1;
    const double first = value(i), second = value(i + 1);
    if ((first - middle) * (second - middle) > 0.0 || first == second) continue;
    return (i + (middle - first) / (second - first)) * kStep;
  }
  return std::nullopt;
}

/// A line: normal . p = distance.
struct EdgeLine {
  Eigen::Vector2d normal;
  double distance = 0.0;
};

/// The line along an edge from a to b, without outlying places.
[[nodiscard]] std::optional<EdgeLine> edge_line(const GrayImage& image, const Eigen::Vector2d& a,
                                                const Eigen::Vector2d& b, double reach) {
  const Eigen::Vector2d along = b - a;
  const Eigen::Vector2d normal = Eigen::Vector2d(-along.y(), along.x()).normalized();
  const int places = std::clamp(static_cast<int>(along.norm()), 8, 60);
  std::vector<Eigen::Vector2d> offsets;  // (t, offset)
  for (int i = 0; i < places; ++i) {
    const double t = 0.12 + 0.76 * i / (places - 1);
    if (const auto d = edge_offset(image, a + t * along, normal, reach))
      offsets.emplace_back(t, *d);
  }
  Eigen::Vector2d fit = Eigen::Vector2d::Zero();  // offset = fit(0) + fit(1) (t - 1/2)
  for (int pass = 0; pass < 2; ++pass) {
    if (2 * static_cast<int>(offsets.size()) < places) return std::nullopt;
    Eigen::Matrix2d sums = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (const auto& o : offsets) {
      const Eigen::Vector2d row(1.0, o.x() - 0.5);
      sums += row * row.transpose();
      right += row * o.y();
    }
    fit = sums.inverse() * right;
    std::erase_if(offsets, [&](const Eigen::Vector2d& o) {
      return std::abs(fit(0) + fit(1) * (o.x() - 0.5) - o.y()) > 0.5;
    });
  }
  const Eigen::Vector2d first = a + (fit(0) - fit(1) / 2.0) * normal,
                        way = b + (fit(0) + fit(1) / 2.0) * normal - first;
  const Eigen::Vector2d across = Eigen::Vector2d(-way.y(), way.x()).normalized();
  return EdgeLine{across, across.dot(first)};
}

void refine_tag(const GrayImage& image, double cell, std::array<Eigen::Vector2d, 4>& corners) {
  // Further inside, bits of the code begin to show: 0.75 of a cell triples the error.
  const double reach = std::clamp(0.5 * cell, 1.5, 6.0);
  std::array<std::optional<EdgeLine>, 4> lines;
  for (std::size_t k = 0; k < 4; ++k) {
    lines[k] = edge_line(image, corners[k], corners[(k + 1) % 4], reach);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const auto &before = lines[(k + 3) % 4], &after = lines[k];
    if (!before || !after) continue;
    Eigen::Matrix2d normals;
    normals << before->normal.transpose(), after->normal.transpose();
    const Eigen::Vector2d at =
        normals.inverse() * Eigen::Vector2d(before->distance, after->distance);
    if ((at - corners[k]).norm() <= 2.0) corners[k] = at;
  }
}

}  // namespace kinecal::detail
