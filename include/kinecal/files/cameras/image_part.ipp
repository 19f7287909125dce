// Binning and region of interest in camera_info: the camera delivers only a part of the full image.
//
// K and P of a CameraInfo belong to the full image, but kinecal uses pixels as they are: those of a
// binned or cropped image do not match K.
// Source: sensor_msgs/CameraInfo, binning_x and roi.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>

#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

struct ImagePart {
  double binning_x = 0.0, binning_y = 0.0;             ///< 0 and 1: none
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;  ///< of the region, pixels; all 0: no region

  [[nodiscard]] bool is_binned() const { return binning_x > 1.0 || binning_y > 1.0; }
  /// @param camera  whose width and height are those of the full image
  [[nodiscard]] bool is_cut(const CameraInfo& camera) const {
    const bool narrow = width != 0.0 && width != camera.width;
    const bool low = height != 0.0 && height != camera.height;
    return x != 0.0 || y != 0.0 || narrow || low;
  }
};

/// The warning about a camera with a partial image; empty if the image is full.
[[nodiscard]] inline std::string doubt_image_part(const ImagePart& part, const CameraInfo& camera) {
  std::string what;
  if (part.is_binned()) what = fmt::format("binning {} x {}", part.binning_x, part.binning_y);
  if (part.is_cut(camera)) {
    what += fmt::format("{}a region of interest of {} x {} pixels at {}, {}",
                        what.empty() ? "" : " and ", part.width, part.height, part.x, part.y);
  }
  if (what.empty()) return what;
  return "camera_info has " + what +
         ", which is not used: K and P are those of the full image, and pixels must be, too; else "
         "give the intrinsics of the recorded image";
}

}  // namespace kinecal::detail
