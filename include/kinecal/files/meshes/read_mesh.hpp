// Reads meshes of triangles: STL, DAE (COLLADA) and OBJ.
//
// Uses no library: a URDF and its meshes may come from anywhere, and assimp 5.2 crashes the program
// if one letter of a DAE file is changed.
//
// Meshes are only for display, so wrong parts of a file are dropped if possible: vertices that are
// NaN, triangles without area or with missing vertices.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "kinecal/files/meshes/find_mesh.hpp"
#include "kinecal/files/meshes/mesh.hpp"

namespace kinecal {

/// Limits on the size of a mesh.
struct MeshLimits {
  std::size_t triangles = 20000;                    ///< a larger mesh is simplified
  std::uintmax_t bytes = std::uintmax_t{64} << 20;  ///< a larger file is not read
};

/// The mesh of a file, in metres.  Like RViz, applies the unit of a DAE file but not its up axis.
/// @throws MeshError  if it cannot be read: the reason, without the name of the file
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& file, const MeshLimits& limits = {});

/// A simplified mesh with at most this many triangles: merges the vertices in each cell of a grid.
/// Uses the finest of a few grids, so the result may have far fewer.
[[nodiscard]] Mesh thinned(const Mesh& mesh, std::size_t triangles);

namespace detail {

/// The mesh without parts that cannot be drawn.
/// @param mesh  may have NaN vertices, invalid indices and triangles without area
[[nodiscard]] Mesh cleaned(const Mesh& mesh);

/// The mesh in a file's bytes, unchanged.
/// @param type  extension of the file: "stl", "dae" or "obj"
/// @throws MeshError
[[nodiscard]] Mesh mesh_of(const std::string& bytes, const std::string& type);

}  // namespace detail

}  // namespace kinecal
