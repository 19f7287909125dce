// Reads meshes of triangles: STL, DAE (COLLADA) and OBJ.
//
// They are read here and not by a library: a URDF and its meshes may come from anywhere, and assimp 5.2 ends
// the program when one letter of a DAE file is changed.
//
// A mesh is for looking at.  So what is wrong in a file is left out where that is possible: vertices that
// are not numbers, triangles without area or beyond the vertices.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "kinecal/files/meshes/find_mesh.hpp"
#include "kinecal/files/meshes/mesh.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

/// What of a mesh is read.
struct MeshLimits {
  std::size_t triangles = 20000;                    ///< above it, the mesh is thinned
  std::uintmax_t bytes = std::uintmax_t{64} << 20;  ///< above it, a file is not read
};

/// The mesh of a file, in metres.  The unit of a DAE file counts, its up axis does not: as in RViz.
/// @throws MeshError  if it cannot be read: a sentence without the name of the file
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& file, const MeshLimits& limits = {});

/// A mesh of at most so many triangles: vertices in one cell of a grid become one.  The grid is the finest
/// of a few, so the result may have far fewer.
[[nodiscard]] Mesh thinned(const Mesh& mesh, std::size_t triangles);

namespace detail {

/// The mesh without what cannot be drawn.
/// @param mesh  vertices that are not numbers, indices that do not exist, triangles without area
[[nodiscard]] Mesh cleaned(const Mesh& mesh);

/// The mesh of a file's bytes, as it is.
/// @param type  extension of the file: "stl", "dae" or "obj"
/// @throws MeshError
[[nodiscard]] Mesh mesh_of(const std::string& bytes, const std::string& type);

}  // namespace detail

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/meshes/read_mesh.ipp"
#endif
