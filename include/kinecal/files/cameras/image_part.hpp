// Binning and region of interest in camera_info: the camera delivers only a part of the full image.
//
// K and P of a CameraInfo belong to the full image, but kinecal uses pixels as they are: those of a
// binned or cropped image do not match K.
// Source: sensor_msgs/CameraInfo, binning_x and roi.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

struct ImagePart {
  double binning_x = 0.0, binning_y = 0.0;             ///< 0 and 1: none
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;  ///< of the region, pixels; all 0: no region

  [[nodiscard]] bool is_binned() const { return binning_x > 1.0 || binning_y > 1.0; }
  /// @param camera  whose width and height are those of the full image
  [[nodiscard]] bool is_cut(const CameraInfo& camera) const;
};

/// The warning about a camera with a partial image; empty if the image is full.
[[nodiscard]] std::string doubt_image_part(const ImagePart& part, const CameraInfo& camera);

}  // namespace kinecal::detail
