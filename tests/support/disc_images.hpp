// Grids of discs, as printed.
#pragma once

#include <cmath>

#include "kinecal/capture/finders/circle_grid_finder.hpp"
#include "support/board_images.hpp"

namespace kinecal::test {

/// The place of a disc on its grid, metres.
inline Vector3<double> disc_place(const CircleGridSettings& s, int column, int row) {
  return {(s.asymmetric ? 2 * column + row % 2 : column) * s.size, row * s.size, 0.0};
}

/// Black discs with a white margin, of less than half a step.
inline Print disc_print(const CircleGridSettings& s, double radius) {
  const Vector3<double> last = disc_place(s, s.points_x - 1, s.points_y - 1);
  return [=](double x, double y) {
    const double margin = 1.5 * s.size, right = last.x() + (s.asymmetric ? s.size : 0.0);
    if (x < -margin || y < -margin || x > right + margin || y > last.y() + margin) return -1.0;
    const int row = static_cast<int>(std::lround(y / s.size)), shift = s.asymmetric ? row % 2 : 0,
              column = static_cast<int>(std::lround((x / s.size - shift) / (s.asymmetric ? 2 : 1)));
    if (row < 0 || column < 0 || row >= s.points_y || column >= s.points_x) return 1.0;
    const Vector3<double> at = disc_place(s, column, row);
    return std::hypot(x - at.x(), y - at.y()) <= radius ? 0.0 : 1.0;
  };
}

/// White on black in place of black on white.
inline Print negative(const Print& print) {
  return [=](double x, double y) {
    const double value = print(x, y);
    return value < 0.0 ? value : 1.0 - value;
  };
}

}  // namespace kinecal::test
