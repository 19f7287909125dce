// Definitions of tag_code.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/tags/tag_code.hpp"

#include <Eigen/LU>
#include <bit>
#include <cmath>

#include "kinecal/capture/boards/homography.hpp"
#include "kinecal/capture/boards/square_edges.hpp"

namespace kinecal::detail {

const std::vector<Eigen::Vector2d>& unit_tag() {
  static const std::vector<Eigen::Vector2d> corners = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  return corners;
}

namespace {

/// A point of the unit tag, turned by quarter turns about its middle.
[[nodiscard]] Eigen::Vector2d quarter_turned(const Eigen::Vector2d& p, int turns) {
  if (turns == 1) return {1.0 - p.y(), p.x()};
  if (turns == 2) return {1.0 - p.x(), 1.0 - p.y()};
  if (turns == 3) return {p.y(), 1.0 - p.x()};
  return p;
}

/// Brightness between black and white over a tag: a plane.
struct TagShade {
  Vector3<double> plane = {0, 0, 0};  ///< a + b x + c y
  double contrast = 0.0;

  [[nodiscard]] double at(const Eigen::Vector2d& p) const {
    return plane.dot(Vector3<double>(1.0, p.x(), p.y()));
  }
};

/// From the middle of the black border and the white gap beside it.
[[nodiscard]] TagShade shade_of(const GrayImage& image, const TagCodes& codes,
                                const Matrix3<double>& h) {
  const double cell = 1.0 / codes.cells, inside = 0.5 * codes.border * cell;
  Matrix3<double> sums = Matrix3<double>::Zero();
  Vector3<double> right = Vector3<double>::Zero();
  double white = 0.0, black = 0.0;
  constexpr int kPlaces = 8;
  for (int side = 0; side < 4; ++side) {
    for (int i = 0; i < kPlaces; ++i) {
      const double along = 0.15 + 0.7 * i / (kPlaces - 1);
      const Eigen::Vector2d dark = quarter_turned({along, inside}, side),
                            bright = quarter_turned({along, -cell}, side);
      const double low = brightness_at(image, mapped(h, dark)),
                   high = brightness_at(image, mapped(h, bright));
      const Eigen::Vector2d middle = 0.5 * (dark + bright);
      const Vector3<double> terms(1.0, middle.x(), middle.y());
      sums += terms * terms.transpose();
      right += terms * 0.5 * (low + high);
      black += low;
      white += high;
    }
  }
  return {sums.inverse() * right, (white - black) / (4 * kPlaces)};
}

/// The brightness of a cell, without what blur adds from its neighbours.
[[nodiscard]] double sharpened(const GrayImage& image, const Matrix3<double>& h,
                               const Eigen::Vector2d& at, double cell) {
  constexpr double kShare = 0.25;
  const Eigen::Vector2d x(cell, 0.0), y(0.0, cell);
  double around = 0.0;
  for (const Eigen::Vector2d& way : {x, y}) {
    around += brightness_at(image, mapped(h, at + way)) + brightness_at(image, mapped(h, at - way));
  }
  return (1.0 + 4.0 * kShare) * brightness_at(image, mapped(h, at)) - kShare * around;
}

}  // namespace

std::optional<TagReading> read_code(const GrayImage& image, const TagCodes& codes,
                                    const std::array<Eigen::Vector2d, 4>& corners, int wrong_bits) {
  constexpr double kLeastRange = 15.0;
  const auto h = homography(unit_tag(), {corners.begin(), corners.end()});
  if (!h) return std::nullopt;
  const TagShade shade = shade_of(image, codes, *h);
  if (!(shade.contrast > kLeastRange)) return std::nullopt;
  const double cell = 1.0 / codes.cells;
  TagReading best{0, 0, wrong_bits + 1};
  for (int turns = 0; turns < 4; ++turns) {
    std::uint64_t seen = 0;
    for (const Eigen::Vector2d& place : codes.places) {
      const Eigen::Vector2d at = quarter_turned(place, turns);
      seen = (seen << 1U) | (sharpened(image, *h, at, cell) > shade.at(at) ? 1U : 0U);
    }
    for (std::size_t id = 0; id < codes.codes.size(); ++id) {
      const int wrong = std::popcount(seen ^ codes.codes[id]);
      if (wrong < best.wrong_bits) best = {static_cast<int>(id), turns, wrong};
    }
  }
  if (best.wrong_bits > wrong_bits) return std::nullopt;
  return best;
}

}  // namespace kinecal::detail
