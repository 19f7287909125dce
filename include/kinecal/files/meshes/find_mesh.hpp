// Finds the mesh files named in a URDF: package://fetch_description/meshes/base_link.dae.
//
// Packages are searched, in this order, in the folders that the user gives, in ROS_PACKAGE_PATH, in
// <prefix>/share of AMENT_PREFIX_PATH, and in the folders above the URDF.  Never downloads
// anything, and never reads outside the folders found: a URDF may come from anywhere.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace kinecal {

/// A mesh that cannot be drawn; the reason, without its name.
struct MeshError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Folders to search for packages and meshes.
struct MeshPlaces {
  std::filesystem::path urdf = {};                       ///< folder of the URDF
  std::vector<std::filesystem::path> given = {};         ///< packages, or folders of packages
  std::vector<std::filesystem::path> ros_packages = {};  ///< ROS_PACKAGE_PATH
  std::vector<std::filesystem::path> prefixes = {};      ///< AMENT_PREFIX_PATH
};

/// The folders for a URDF, including those of the environment.
/// @param urdf   its file
/// @param given  by the user
[[nodiscard]] MeshPlaces mesh_places(const std::filesystem::path& urdf,
                                     const std::vector<std::string>& given = {});

/// The folder of a package: $(find fetch_description) of launch files.
/// @throws MeshError  if it is not in any of the folders
[[nodiscard]] std::filesystem::path find_package(const std::string& package,
                                                 const MeshPlaces& places);

/// The file of a mesh.
/// @param name  package://..., file://..., or relative to the URDF
/// @throws MeshError  if it is missing or outside its package
[[nodiscard]] std::filesystem::path find_mesh(const std::string& name, const MeshPlaces& places);

}  // namespace kinecal
