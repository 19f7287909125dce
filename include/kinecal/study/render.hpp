// Pictures of a scene, by casting rays through the pixels of a lens.
//
// A pixel is the mean over its area: where patches or parts of a picture meet, 128 rays in a lattice, no
// two of which share a column or a row, so edges are at their places to 0.02 pixels.  A lamp that shines
// glows around itself.  Tiles of the image know the patches that can be in them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "kinecal/study/scene.hpp"
#include "kinecal/study/simulated_camera.hpp"

namespace kinecal {

/// The pose of a link in a camera: camera_T_link, metres; the link "" is the base.
using PoseInCamera = std::function<Pose<double>(const std::string& link)>;

/// Renders scenes for one camera; keeps what depends on its lens only.
class Renderer {
 public:
  /// @throws std::invalid_argument  if the camera_info has no size
  /// @throws SettingsError          if it cannot be of a camera
  explicit Renderer(const SimulatedCamera& camera);

  /// The scene as it is at one moment.
  /// @param code  of the LEDs that shine; 0: none
  [[nodiscard]] Picture render(const Scene& scene, const PoseInCamera& pose_of, int code) const;

  [[nodiscard]] const SimulatedLens& lens() const { return lens_; }  ///< of the camera

 private:
  SimulatedLens lens_;
  double grazing_;
  Image<Vector3<double>> corners_;  ///< rays through the corners of pixels
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/study/render.ipp"
#endif
