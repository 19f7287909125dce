// Reads OBJ files: lines of vertices (v x y z) and of polygons (f 1/2/3 ...), counted from 1 or, if
// negative, from the last vertex so far.  Ignores everything else.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

#include "kinecal/files/meshes/find_mesh.hpp"
#include "kinecal/files/meshes/mesh.hpp"
#include "kinecal/files/meshes/mesh_numbers.ipp"

namespace kinecal::detail {

/// Adds a polygon as triangles about its first corner.
inline void add_polygon(const std::vector<std::uint32_t>& corners, Mesh& mesh) {
  for (std::size_t i = 2; i < corners.size(); ++i) {
    mesh.triangles.insert(mesh.triangles.end(), {corners[0], corners[i - 1], corners[i]});
  }
}

/// The corners of a line "f 1/2/3 4/5/6 ...".
[[nodiscard]] inline std::vector<std::uint32_t> obj_corners(std::string_view line,
                                                            std::size_t vertices) {
  std::vector<std::uint32_t> corners;
  while (const auto index = next_number<std::int64_t>(line)) {
    const std::int64_t place =
        *index < 0 ? static_cast<std::int64_t>(vertices) + *index : *index - 1;
    // If it does not exist, its triangle is dropped later.
    corners.push_back(static_cast<std::uint32_t>(
        place < 0 ? UINT32_MAX : std::min<std::int64_t>(place, UINT32_MAX)));
    line.remove_prefix(std::min(line.find_first_of(" \t\r"), line.size()));  // texture, normal
  }
  return corners;
}

[[nodiscard]] inline Mesh obj_mesh(std::string_view text) {
  Mesh mesh;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with("v ") || line.starts_with("v\t")) {
      line.remove_prefix(1);
      for (int k = 0; k < 3; ++k) {
        const auto number = next_number<float>(line);
        if (!number) throw MeshError("has a vertex that is not three numbers");
        mesh.vertices.push_back(*number);
      }
    } else if (line.starts_with("f ") || line.starts_with("f\t")) {
      add_polygon(obj_corners(line.substr(1), mesh.num_vertices()), mesh);
    }
  }
  return mesh;
}

}  // namespace kinecal::detail
