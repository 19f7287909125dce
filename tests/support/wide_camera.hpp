// A wide camera before which a person held a board 30 times, as the corners that were found.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <random>
#include <string>

#include "kinecal/geometry/rpy.hpp"
#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal::test {

/// Samples of a fisheye that saw a board, in YAML: nothing is known of it but the size of its image.
/// @param far          samples from this one on have another image size
/// @param first, last  of 30, from 0: the last one is not in it
inline std::string wide_camera_samples(int far = 1000, int first = 0, int last = 30) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> side(-0.5, 0.5), tilt(-0.6, 0.6);
  std::normal_distribution<double> noise(0.0, 0.1);  // pixels
  const std::array<double, 4> lens = {0.02, -0.004, 0.0, 0.0};
  std::string text;
  for (int n = 0; n < 30; ++n) {
    const Pose<double> camera_T_board{
        rotation_from_rpy({tilt(random), tilt(random), 3.0 * tilt(random)}),
        {side(random) - 0.15, side(random) - 0.1, 0.45 + 0.3 * side(random)}};
    std::string board, seen;
    for (int i = 0; i < 54; ++i) {
      const Vector3<double> corner(0.035 * (i % 9), 0.035 * (i / 9), 0.0);
      const Eigen::Vector2d at = Equidistant::image(Vector3<double>(camera_T_board * corner), lens);
      board += fmt::format("  - {{header: {{frame_id: board}}, point: {{x: {}, y: {}, z: 0}}}}\n",
                           corner.x(), corner.y());
      seen += fmt::format("  - {{header: {{frame_id: camera}}, point: {{x: {}, y: {}, z: 0}}}}\n",
                          640 + 380 * at.x() + noise(random), 500 + 381 * at.y() + noise(random));
    }
    if (n < first || n >= last) continue;
    text += fmt::format(
        "joint_states: {{name: [], position: []}}\nobservations:\n- sensor_name: board\n  "
        "features:\n{}- sensor_name: camera\n  features:\n{}  ext_camera_info: {{camera_info: "
        "{{width: {}, height: 960}}}}\n---\n",
        board, seen, n < far ? 1280 : 640);
  }
  return text;
}

}  // namespace kinecal::test
