// Pictures of a scene: casts rays through the pixels of a lens.
//
// A pixel is the mean over its area.  Where patches or parts of a picture meet, it uses 128 rays in
// a lattice, no two in the same column or row, so edges are accurate to 0.02 pixels.  A lit lamp
// glows around itself.  Tiles of the image know what may appear in them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "kinecal/study/scene.hpp"
#include "kinecal/study/simulated_camera.hpp"

namespace kinecal {

/// The pose of a link in a camera: camera_T_link, metres; the link "" is the base.
using PoseInCamera = std::function<Pose<double>(const std::string& link)>;

/// Renders scenes for one camera; keeps what depends only on its lens.
class Renderer {
 public:
  /// @throws std::invalid_argument  if the camera_info has no size
  /// @throws SettingsError          if no camera can have it
  explicit Renderer(const SimulatedCamera& camera);

  /// The scene at one moment.
  /// @param code  of the LEDs that are lit; 0: none
  [[nodiscard]] Picture render(const Scene& scene, const PoseInCamera& pose_of, int code) const;

  [[nodiscard]] const SimulatedLens& lens() const { return lens_; }  ///< of the camera

 private:
  SimulatedLens lens_;
  double grazing_;
  Image<Vector3<double>> corners_;  ///< rays through the corners of pixels
};

}  // namespace kinecal
