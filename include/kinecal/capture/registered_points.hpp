// Depth of one camera as another camera would measure it: registered to its image.
//
// The depth image is a surface of triangles between neighbouring pixels, drawn into the other image; where several
// are drawn, the nearest one counts.  Between a near and a far surface there is no depth: the near one may reach to
// the next pixel, and hides what is behind it there.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/image.hpp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/sensors/lenses/lens.hpp"

namespace kinecal {

/// A camera that measures depth beside another one.
struct RangeCamera {
  CameraInfo info;                         ///< its own
  ImageKind image = ImageKind::automatic;  ///< raw or rectified
  Pose<double> camera_T_depth =
      Pose<double>{};  ///< its optical frame in that of the other camera, metres
};

/// The points that the other camera would have measured.
/// @param depth   image of the depth camera
/// @param camera  the other camera; its image is of `image`
/// @returns       organised cloud of the size of the other camera's image, metres, in its optical frame
/// @throws std::invalid_argument  if the depth image has another size than its camera
/// @throws SettingsError          if a camera_info cannot be of a camera
[[nodiscard]] PointCloud registered_points(const DepthImage& depth, const RangeCamera& from,
                                           const CameraInfo& camera,
                                           ImageKind image = ImageKind::automatic);

}  // namespace kinecal
