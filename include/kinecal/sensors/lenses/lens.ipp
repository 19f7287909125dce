// Definitions of lens.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/built_in_sensor.hpp"
#include "kinecal/sensors/lenses/lens.hpp"

namespace kinecal {

KINECAL_INLINE Lens::Lens(const CameraInfo& info, ImageKind image, std::span<const double> errors)
    : camera_(any_built_in(lens_camera(is_raw(info, image) ? lens_of(info) : "plumb_bob", image))),
      settings_(camera_->settings({"camera", {}, info})),
      errors_(camera_->parameters().size(), 0.0) {
  std::copy_n(errors.begin(), std::min(errors.size(), errors_.size()), errors_.begin());
}

}  // namespace kinecal
