// Images and organised point clouds: what cameras deliver and finders read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "kinecal/geometry/rotation.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Pixels, row by row from the top left.  The centre of the first pixel is at u = 0, v = 0.
template <class P>
struct Image {
  int width = 0;          ///< pixels
  int height = 0;         ///< pixels
  std::vector<P> pixels;  ///< width * height, row-major

  Image() = default;
  /// An image of equal pixels.
  Image(int columns, int rows, P fill = {})
      : width(columns),
        height(rows),
        pixels(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), fill) {}

  /// True if it has no pixels.
  [[nodiscard]] bool empty() const { return pixels.empty(); }

  /// True if a pixel (column, row) is in the image.
  [[nodiscard]] bool contains(int u, int v) const {
    return u >= 0 && v >= 0 && u < width && v < height;
  }

  /// The pixel in column u and row v; it must be in the image.
  [[nodiscard]] P& operator()(int u, int v) { return pixels[index(u, v)]; }
  [[nodiscard]] const P& operator()(int u, int v) const {
    return pixels[index(u, v)];
  }  ///< the same

 private:
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u);
  }
};

/// Brightness, 0 to 255.
using GrayImage = Image<std::uint8_t>;
/// Distance along the optical axis, metres; NaN where nothing was measured.
using DepthImage = Image<float>;
/// Points (3), metres, in the optical frame; NaN where nothing was measured.  "Organised": same
/// size as the image, one point per pixel.  An unordered cloud has one row.
using PointCloud = Image<Vector3<float>>;

/// The value of a missing point.
[[nodiscard]] inline Vector3<float> no_point() {
  return Vector3<float>::Constant(std::numeric_limits<float>::quiet_NaN());
}

/// The points of a depth image: x = (u - cx) z / fx, y = (v - cy) z / fy, with P of the camera.
/// @throws std::invalid_argument  if a focal length of P is not positive, or the sizes differ
[[nodiscard]] PointCloud points_of(const DepthImage& depth, const CameraInfo& camera);

}  // namespace kinecal
