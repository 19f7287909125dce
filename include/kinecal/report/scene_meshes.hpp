// The appearance of a scene's links: the visuals of the URDF with their meshes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "kinecal/files/meshes/find_mesh.hpp"
#include "kinecal/report/robot_scene.hpp"

namespace kinecal {

/// Limit on all meshes of a scene together; beyond it, they are simplified.
struct MeshBudget {
  std::size_t triangles = 60000;
  std::size_t bytes = 900000;  ///< of vertices and triangles; base64 adds a third
};

/// Adds visuals to the links of a scene, and reads their meshes.  Skips those that cannot be drawn,
/// with a warning.
/// @param name  of the URDF in warnings
void add_visuals(std::span<const Visual> visuals, const MeshPlaces& places, const std::string& name,
                 RobotScene& scene, Diagnostics& diagnostics, const MeshBudget& budget = {});

}  // namespace kinecal
