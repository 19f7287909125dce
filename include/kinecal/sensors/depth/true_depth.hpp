// The true depth of a pixel, for drivers: what depth_correction_<camera>.yaml says of a depth camera.
// Needs only the standard library, so a driver may take this file alone.
//
//   DepthErrors camera;                    // the numbers of the file, by its names
//   camera.fx = 525.0;
//   camera.z_quadratic = 0.004;
//   const double z = true_depth(camera, u, v, measured);
//
//   x = (u - cx) / fx      y = (v - cy) / fy
//   z1 = (measured / recorded_z_scaling - recorded_z_offset + z_offset) (1 + z_scaling)
//   z = z1 (1 + z_quadratic z1 + z_x x + z_y y + z_xx x^2 + z_xy x y + z_yy y^2)
//
// If the driver has z_offset and z_scaling already, write recorded_z_offset = z_offset and
// recorded_z_scaling = 1 + z_scaling.  The point is then z times the ray of the pixel with the calibrated
// intrinsics, those of depth_<camera>.yaml; fx fy cx cy here are the ones while recording.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinecal {

/// How a camera's depth differs from the true one; names and units as in depth_correction_<camera>.yaml.
struct DepthErrors {
  double fx = 1.0, fy = 1.0, cx = 0.0, cy = 0.0;  ///< of the image while recording, pixels
  double recorded_z_offset = 0.0;                 ///< of the driver while recording, metres
  double recorded_z_scaling = 1.0;                ///< of the driver while recording, a factor
  double z_offset = 0.0;                          ///< metres
  double z_scaling = 0.0;                         ///< relative
  double z_quadratic = 0.0;                       ///< 1/m
  double z_x = 0.0, z_y = 0.0;                    ///< relative, per focal length from the center
  double z_xx = 0.0, z_xy = 0.0, z_yy = 0.0;      ///< relative, per square of it
};

/// The true depth, metres; a depth that is not positive, of a pixel without measurement, as it is.
/// @param u, v      pixel
/// @param measured  depth that the driver gives, metres along the optical axis
[[nodiscard]] inline double true_depth(const DepthErrors& e, double u, double v, double measured) {
  if (!(measured > 0.0)) return measured;
  const double x = (u - e.cx) / e.fx, y = (v - e.cy) / e.fy;
  const double raw = measured / e.recorded_z_scaling - e.recorded_z_offset;
  const double z = (raw + e.z_offset) * (1.0 + e.z_scaling);
  return z * (1.0 + e.z_quadratic * z + e.z_x * x + e.z_y * y + e.z_xx * x * x + e.z_xy * x * y +
              e.z_yy * y * y);
}

}  // namespace kinecal
