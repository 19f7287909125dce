// Definitions of find_mesh.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/meshes/find_mesh.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>

#include "kinecal/files/ros_package.ipp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {

namespace fs = std::filesystem;

/// The folders of an environment variable.
[[nodiscard]] inline std::vector<fs::path> folders_of_variable(const char* variable) {
  const char* value = std::getenv(variable);
  std::vector<fs::path> folders;
  std::string_view rest = value == nullptr ? "" : value;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) folders.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return folders;
}

/// True if a path is in a folder; both must be canonical.
[[nodiscard]] inline bool is_inside(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first ==
         folder.end();
}

/// Folders of a package, in search order.
[[nodiscard]] inline std::vector<fs::path> package_folders(const std::string& package,
                                                           const MeshPlaces& places) {
  std::vector<fs::path> all;
  const auto add = [&](const fs::path& folder) {
    if (is_package(folder, package)) all.push_back(folder);
  };
  for (const fs::path& folder : places.given) {
    const auto canonical = canonical_path(folder);
    if (!canonical) continue;
    add(*canonical);
    add(*canonical / package);
    add(*canonical / "share" / package);
  }
  for (const fs::path& folder : places.ros_packages) {
    add(folder);
    add(folder / package);
  }
  for (const fs::path& prefix : places.prefixes) add(prefix / "share" / package);
  for (const fs::path& folder : with_parents(places.urdf)) {
    add(folder);
    add(folder / package);
  }
  return all;
}

/// The folder in which a URDF may name files without a package: that of its package, or its own.
[[nodiscard]] inline fs::path own_folder(const MeshPlaces& places) {
  const std::vector<fs::path> all = with_parents(places.urdf);
  for (const fs::path& folder : all) {
    std::error_code missing;
    if (fs::is_regular_file(folder / "package.xml", missing)) return folder;
  }
  return all.empty() ? fs::path() : all.front();
}

/// A file, if it exists inside one of the folders.
/// @throws MeshError  if it is outside all of them
[[nodiscard]] inline std::optional<fs::path> file_inside(const fs::path& file,
                                                         const std::vector<fs::path>& folders) {
  const auto found = canonical_path(file);
  if (!found) return std::nullopt;
  const bool inside = std::any_of(folders.begin(), folders.end(), [&](const fs::path& folder) {
    const auto canonical = canonical_path(folder);
    return canonical && is_inside(*found, *canonical);
  });
  if (!inside) {
    throw MeshError(
        "is outside of the robot's packages and of the URDF's folder; give its folder with "
        "--mesh-path");
  }
  std::error_code missing;
  return fs::is_regular_file(*found, missing) ? found : std::nullopt;
}

/// Decodes "%20" as a space.
[[nodiscard]] inline std::string decoded(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string digits(text.substr(std::min(i + 1, text.size()), 2));
    const bool code = text[i] == '%' && digits.size() == 2 &&
                      digits.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos &&
                      digits != "00";
    plain += code ? static_cast<char>(std::stoi(digits, nullptr, 16)) : text[i];
    if (code) i += 2;
  }
  return plain;
}

[[nodiscard]] inline fs::path find_in_package(const std::string& rest, const MeshPlaces& places) {
  const std::string package = rest.substr(0, rest.find('/'));
  if (package.empty() || package == "." || package == "..") throw MeshError("names no package");
  const std::vector<fs::path> folders = package_folders(package, places);
  if (folders.empty()) {
    throw MeshError("is of package '" + printable(package) +
                    "', which was not found; give its folder with --mesh-path");
  }
  const fs::path inside = fs::path(rest.substr(std::min(package.size() + 1, rest.size())));
  if (inside.is_absolute()) throw MeshError("names no file of its package");
  std::string why = "is not in " + printable(folders.front().string());
  for (const fs::path& folder : folders) {
    try {
      if (const auto file = file_inside(folder / inside, {folder})) return *file;
    } catch (const MeshError& e) {  // another folder may have the file itself instead of a link
      why = e.what();
    }
  }
  throw MeshError(why);
}

}  // namespace detail

MeshPlaces mesh_places(const std::filesystem::path& urdf, const std::vector<std::string>& given) {
  return {.urdf = urdf.parent_path(),
          .given = {given.begin(), given.end()},
          .ros_packages = detail::folders_of_variable("ROS_PACKAGE_PATH"),
          .prefixes = detail::folders_of_variable("AMENT_PREFIX_PATH")};
}

std::filesystem::path find_package(const std::string& package, const MeshPlaces& places) {
  const std::vector<detail::fs::path> folders = detail::package_folders(package, places);
  if (!folders.empty()) return folders.front();
  throw MeshError("package '" + printable(package) +
                  "' was not found; name the folder above it in ROS_PACKAGE_PATH");
}

std::filesystem::path find_mesh(const std::string& name, const MeshPlaces& places) {
  constexpr std::string_view kPackage = "package://", kFile = "file://";
  const std::string plain = detail::decoded(name);
  try {
    if (plain.starts_with(kPackage)) {
      return detail::find_in_package(plain.substr(kPackage.size()), places);
    }
    const bool is_file = plain.starts_with(kFile);
    if (!is_file && plain.find("://") != std::string::npos) {
      throw MeshError("is not a local file, and nothing is fetched");
    }
    const std::filesystem::path path = is_file ? plain.substr(kFile.size()) : plain;
    std::vector<std::filesystem::path> folders = places.given;
    for (const auto* more : {&places.ros_packages, &places.prefixes}) {
      folders.insert(folders.end(), more->begin(), more->end());
    }
    folders.push_back(detail::own_folder(places));
    const auto file = detail::file_inside(path.is_absolute() ? path : places.urdf / path, folders);
    if (file) return *file;
  } catch (const std::filesystem::filesystem_error&) {  // an impossible file name
  }
  throw MeshError("is not there");
}

}  // namespace kinecal
