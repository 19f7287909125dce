// A camera by photographs of a flat target, and nothing else: for the start of start_cameras().
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/cameras/camera_start.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A camera, and where the target was.
struct SingleCamera {
  CameraInfo info;  ///< K, and D of the wanted lens
  std::vector<std::optional<Pose<double>>>
      poses;  ///< camera_T_target of each view, as far as it is known
};

/// Calibrates a camera alone, as a fisheye; then gives it a lens that is as close to that as it can.
/// @param width, height  of the image, pixels
/// @param lens           of lens_names(); empty: plumb_bob for a narrow camera, else rational_polynomial
/// @returns  nullopt if no view has four corners that are not on a line
[[nodiscard]] std::optional<SingleCamera> single_camera(std::span<const TargetView> views,
                                                        double width, double height,
                                                        const std::string& lens);

}  // namespace kinecal
