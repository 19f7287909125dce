// Definitions of initial_cameras.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/cameras/initial_cameras.hpp"

#include <fmt/format.h>

#include <set>
#include <stdexcept>

#include "kinecal/files/yaml/yaml_text.hpp"

namespace kinecal {

std::string initial_cameras(const std::vector<std::string>& cameras) {
  if (cameras.empty()) throw std::invalid_argument("no camera is named");
  std::set<std::string> names = {"board"};
  std::string models, frames, blocks;
  for (const std::string& camera : cameras) {
    if (camera.empty() || !names.insert(camera).second) {
      throw std::invalid_argument("the name '" + camera + "' is empty, or taken");
    }
    const std::string name = detail::name_to_yaml(camera);
    models += fmt::format(" - {{name: {0}, type: camera2d, frame: {0}, lens: auto}}\n", name);
    blocks +=
        fmt::format(" - {{name: {}, type: chain3d_to_camera2d, model_3d: board, model_2d: {}}}\n",
                    detail::name_to_yaml("corners_of_" + camera), name);
    if (camera == cameras.front()) continue;
    frames += fmt::format(
        " - {{name: {}, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}}\n",
        detail::name_to_yaml(camera + "_joint"));
  }
  return fmt::format(
      "# Cameras alone: intrinsics, lenses{} and how the board is bent.\n\n"
      "base_link: {}\n"
      "per_sample: [board]  # somebody holds it: it has a pose of its own in each sample\n\n"
      "models:\n - {{name: board, type: board, frame: board}}\n{}\n"
      "# `lens: auto` frees the intrinsics and coefficients of the simplest lens that fits.  To "
      "choose one, write\n"
      "# plumb_bob, rational_polynomial, equidistant or double_sphere, and free its parameters: "
      "camera_fx, camera_k1.\n"
      "free_params: [board_bend_x, board_bend_y]\n{}\nerror_blocks:\n{}",
      frames.empty() ? "" : ", where they stand on the body", detail::name_to_yaml(cameras.front()),
      models, frames.empty() ? "" : "\nfree_frames:\n" + frames, blocks);
}

}  // namespace kinecal
