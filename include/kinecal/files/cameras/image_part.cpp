// Definitions of image_part.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/cameras/image_part.hpp"

#include <fmt/format.h>

namespace kinecal::detail {

bool ImagePart::is_cut(const CameraInfo& camera) const {
  const bool narrow = width != 0.0 && width != camera.width;
  const bool low = height != 0.0 && height != camera.height;
  return x != 0.0 || y != 0.0 || narrow || low;
}

std::string doubt_image_part(const ImagePart& part, const CameraInfo& camera) {
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
