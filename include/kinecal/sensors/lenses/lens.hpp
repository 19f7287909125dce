// A lens by its camera_info: where a point appears in the image, and what a pixel shows.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/sensors/any_sensor.hpp"
#include "kinecal/sensors/camera_image.hpp"

namespace kinecal {

/// The lens of a camera.
class Lens {
 public:
  /// @param errors  of its parameters, in their order; empty: it is as camera_info says
  /// @throws SettingsError  if the camera_info cannot be of a camera
  explicit Lens(const CameraInfo& info, ImageKind image = ImageKind::automatic,
                std::span<const double> errors = {});

  /// The pixel at which a point appears.
  /// @param p  (3) metres, in the optical frame; not a number where the lens does not see it
  [[nodiscard]] Eigen::Vector2d project(const Vector3<double>& p) const {
    return camera_->predict(p, settings_, errors_);
  }
  /// What a pixel shows.
  /// @returns  (3) direction in the optical frame: (x, y, 1) of a pinhole, of another lens any length
  [[nodiscard]] Vector3<double> ray(double u, double v) const {
    return camera_->place({u, v, 0.0}, settings_, errors_);
  }
  /// Pixels, along the rows.
  [[nodiscard]] double focal_length() const { return settings_[0]; }

 private:
  std::shared_ptr<const AnySensor> camera_;
  std::vector<double> settings_, errors_;
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/sensors/lenses/lens.ipp"
#endif
