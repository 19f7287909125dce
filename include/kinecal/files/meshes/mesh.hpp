// A mesh of triangles, as viewers draw it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace kinecal {

/// Triangles.
struct Mesh {
  std::vector<float> vertices;           ///< x y z of each, metres
  std::vector<std::uint32_t> triangles;  ///< three vertices of each, from 0

  [[nodiscard]] std::size_t num_vertices() const { return vertices.size() / 3; }    ///< number
  [[nodiscard]] std::size_t num_triangles() const { return triangles.size() / 3; }  ///< number
};

}  // namespace kinecal
