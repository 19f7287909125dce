// What the pixels of a camera are of, and its camera_info after a calibration.
// Source: sensor_msgs/CameraInfo.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "kinecal/linkage.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// What the pixels of a camera are of.
enum class ImageKind {
  automatic,  ///< raw if camera_info has a distortion, else rectified; where K or P is zero, by the
              ///< other one
  raw,        ///< as the lens shows it: K and D
  rectified   ///< without distortion: P
};

/// Whether an image is raw.  The kind decides; if it is automatic, the camera_info.
/// @param own_lens  the name of a lens that is not in lens_names(): a camera_info of it is of a raw image
[[nodiscard]] bool is_raw(const CameraInfo& info, ImageKind image, std::string_view own_lens = {});

/// Focal lengths and principal point of an image: fx fy cx cy of K for a raw one, of P for a rectified one.
[[nodiscard]] std::array<double, 4> intrinsics_of(const CameraInfo& info, bool raw);

/// The camera_info of an observation.
/// @throws SettingsError  if it has none
[[nodiscard]] const CameraInfo& camera_info_of(const Observation& seen);

/// Checks that settings are numbers and focal lengths are positive.
/// @param settings  fx fy, then others
/// @throws SettingsError
void check_camera_settings(std::span<const double> settings);

/// The intrinsics that a calibration found.  f = f0 (1 + v)  c = c0 (1 + v)
///
/// K and P change alike: points are projected with P, images are rectified with K, and both
/// describe the same lens.  P also contains -fx·Bx and -fy·By of a camera that stands at (Bx, By),
/// metres, in the frame of its points (the second one of a stereo pair).  These are scaled with the
/// focal lengths, because a change of the lens does not move the camera.
///
/// Where it is known what the image was of, its matrix (K of a raw one, P of a rectified one) gets
/// exactly these values, and the other follows so that P K^-1 stays: drivers that rectify with the
/// new K to the new P show the same image as before.  A matrix of zeros stays one.
/// @param camera          as recorded
/// @param fx, fy, cx, cy  relative changes, 0 for none
/// @param image           which matrix they are of; automatic: of both
[[nodiscard]] CameraInfo calibrated_camera_info(const CameraInfo& camera, double fx, double fy,
                                                double cx, double cy,
                                                ImageKind image = ImageKind::automatic);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/sensors/camera_image.ipp"
#endif
