// The surface of a robot: the meshes of its links as trees of triangles, each in the frame of its link.  Boxes, cylinders
// and spheres count where no link has a mesh, and of a link that is listed and has none.
//
//   const RobotSurface surface = read_surface(urdf_text, {.urdf = "robot.urdf", .places = mesh_places("robot.urdf")}, found);
//   const SurfaceHit hit = surface.closest(base_T_links, p_base);
//
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/meshes/find_mesh.hpp"
#include "kinecal/surface/triangle_tree.hpp"

namespace kinecal {

/// The meshes of a URDF that are the surface.
enum class SurfaceGeometry {
  automatic,  ///< visual, or collision where only that has meshes, or shapes
  visual,     ///< `geometry: visual`
  collision   ///< `geometry: collision`
};

/// A link with its surface.
struct SurfaceLink {
  std::string name;   ///< of the link
  TriangleTree tree;  ///< in the frame of the link
};

/// A point of the surface of a robot.
struct SurfaceHit {
  int link = -1;      ///< number of the link in the surface; negative: none within the bound
  int triangle = -1;  ///< of its tree
  Vector3<double> point = Vector3<double>::Zero();  ///< (3) metres, in the link
  Vector3<double> normal =
      Vector3<double>::Zero();  ///< (3) unit vector in the base: see point_to_mesh.hpp
  Vector3<double> face =
      Vector3<double>::Zero();  ///< (3) outward normal of the triangle, in the base
  double distance = std::numeric_limits<double>::infinity();  ///< metres
  double facing =
      1.0;  ///< cosine between the face's normal and the line of sight to it; negative: from behind
};

/// The links of a robot that have a surface.
class RobotSurface {
 public:
  RobotSurface() = default;
  /// @param links  each with its tree
  explicit RobotSurface(std::vector<SurfaceLink> links) : links_(std::move(links)) {}

  /// The links, in the order in which they were given.
  [[nodiscard]] const std::vector<SurfaceLink>& links() const { return links_; }
  /// Number of the link of this name; negative if it has no surface.
  [[nodiscard]] int find(const std::string& link) const;

  /// The nearest point of any link.
  /// @param base_T_links  poses of links(), in their order
  /// @param p_base        (3) metres
  /// @param bound         metres; farther points do not count
  /// @param last          what was found for a point near this one, to search less: link and triangle
  [[nodiscard]] SurfaceHit closest(std::span<const Pose<double>> base_T_links,
                                   const Vector3<double>& p_base,
                                   double bound = std::numeric_limits<double>::infinity(),
                                   const SurfaceHit& last = {}) const;
  /// The first point of any link on a ray; `distance` in lengths of its direction, `normal` of the triangle.
  [[nodiscard]] SurfaceHit cast(std::span<const Pose<double>> base_T_links,
                                const Vector3<double>& origin,
                                const Vector3<double>& direction) const;

 private:
  std::vector<SurfaceLink> links_;
};

/// The surface in one pose of the robot, for many points.
class PosedSurface {
 public:
  /// @param surface       must outlive it
  /// @param base_T_links  poses of its links(), in their order; must outlive it
  PosedSurface(const RobotSurface& surface, std::span<const Pose<double>> base_T_links);
  /// RobotSurface::closest() in this pose.
  [[nodiscard]] SurfaceHit closest(const Vector3<double>& p_base,
                                   double bound = std::numeric_limits<double>::infinity(),
                                   const SurfaceHit& last = {}) const;

 private:
  /// A ball about a link, in the base.
  struct Ball {
    Vector3<double> middle;
    double radius = 0.0;
  };
  const RobotSurface& surface_;
  std::span<const Pose<double>> poses_;
  std::vector<Ball> balls_;
};

/// Of poses of a robot, those that are farthest apart, in turn.
/// @param links  of each: poses of its links in one frame; empty: it does not count
/// @param most   number of them that are wanted
/// @returns  places in `links`
[[nodiscard]] std::vector<std::size_t> farthest_apart(
    std::span<const std::vector<Pose<double>>> links, std::size_t most);

/// What of a URDF is read as a surface.
struct SurfaceSource {
  std::string urdf = {};                                  ///< its name in messages: the file
  MeshPlaces places = {};                                 ///< where meshes are
  SurfaceGeometry geometry = SurfaceGeometry::automatic;  ///< which elements
  std::vector<std::string> links = {};  ///< those whose meshes are needed; empty: all that have one
  SourceLocation place = {};            ///< of what needs them, for messages
};

/// The surface of a URDF's links.
/// @param text         the URDF
/// @param diagnostics  errors: a link without a mesh or shape, a mesh that is missing, cannot be read or has an impossible size;
///                     notes: what is not closed, inside out or without area
[[nodiscard]] RobotSurface read_surface(const std::string& text, const SurfaceSource& source,
                                        Diagnostics& diagnostics);

}  // namespace kinecal
