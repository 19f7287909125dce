// A simulated camera: its true lens, which differs from its camera_info, and its imaging errors.
//
//   depth, as the driver reports it: z1 / (1 + z_scaling) - z_offset + noise z^2, in steps of
//   disparity; z1 is the depth z before the polynomial of sensors/depth/depth_polynomial.hpp
//
// The parameters are those of camera2d and camera3d, which correct for them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "kinecal/capture/view.hpp"
#include "kinecal/sensors/lenses/lens.hpp"
#include "kinecal/study/seeded_random.hpp"

namespace kinecal {

/// 640 x 480 pixels, 554 pixels of focal length, no distortion.
[[nodiscard]] CameraInfo typical_camera_info();

/// The errors of a camera, as parameters of camera2d and camera3d name them.
inline constexpr std::array<std::string_view, 12> kCameraErrors = {
    "fx",          "fy",  "cx",  "cy",   "z_offset", "z_scaling",
    "z_quadratic", "z_x", "z_y", "z_xx", "z_xy",     "z_yy"};

/// A camera.
struct SimulatedCamera {
  std::string frame = "camera_optical_frame";  ///< its optical frame, a link
  CameraInfo info = typical_camera_info();     ///< as its driver reports it
  ImageKind image = ImageKind::automatic;      ///< the kind of its images
  std::array<double, 12> errors{};             ///< of the lens and its depth: kCameraErrors
  double blur = 0.6;                           ///< standard deviation of the point spread, pixels
  double exposure = 1.0;                       ///< factor of all brightness
  double noise = 1.5;           ///< standard deviation of a pixel's brightness, of 255
  bool has_depth = true;        ///< delivers clouds
  double nearest = 0.3;         ///< smallest measured depth, metres
  double farthest = 5.0;        ///< largest measured depth, metres
  double depth_noise = 0.001;   ///< standard deviation at 1 m, metres; grows with the square
  double disparity_step = 0.0;  ///< of structured light, pixels; 0: depth is not quantised
  double baseline = 0.075;      ///< of structured light, metres
  double grazing = 0.17;        ///< smallest cosine to a surface at which depth is measured
  bool has_holes = true;        ///< no depth at edges, at bright lights and at grazing angles
};

/// How a camera's lens projects, truly, and how its driver believes that it does.
class SimulatedLens : public Lens {
 public:
  /// @throws SettingsError  if the camera_info cannot be of a camera
  explicit SimulatedLens(const SimulatedCamera& camera);

  /// The ray of a pixel according to the driver, which does not know the errors.
  /// @returns  (3) direction (x, y, 1)
  [[nodiscard]] Vector3<double> reported_ray(double u, double v) const {
    return reported_.ray(u, v);
  }

 private:
  Lens reported_;
};

/// A picture without noise, as a perfect sensor behind this lens measures it.
struct Picture {
  Image<float> brightness;     ///< 255 is the brightest that a camera reports
  DepthImage depth;            ///< true distance along the optical axis, metres; NaN: nothing there
  Image<std::uint8_t> answer;  ///< 0 where depth is not measurable: grazing, a bright light
};

/// Turns a picture into the image and cloud of a view; without stamp and joints.
/// @param random  of the noise
[[nodiscard]] View photograph(const SimulatedCamera& camera, const SimulatedLens& lens,
                              const Picture& picture, SeededRandom& random);

}  // namespace kinecal
