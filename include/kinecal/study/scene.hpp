// The scene of a simulated camera: flat patches and solids on links of the robot, and their light.
//
// A patch is a rectangle or ellipse with a brightness or a picture.  Six make a box, an
// infinite one the ground, a small round luminous one an LED.  A patch has the axes of an image:
// seen from its front, x points right, y down and z away from the viewer.  A solid has any shape,
// such as the mesh of a link.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/capture/image.hpp"
#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// A flat surface.  Its frame has the origin in its middle, and z points into it.
struct Patch {
  std::string link = {};                          ///< that carries it; empty: the base
  Pose<double> pose = {};                         ///< link_T_patch, metres
  double width = 0.1;                             ///< along x, metres; may be infinite
  double height = 0.1;                            ///< along y, metres; may be infinite
  bool round = false;                             ///< an ellipse
  double albedo = 0.6;                            ///< reflected share of the light, [0, 1]
  std::shared_ptr<const GrayImage> texture = {};  ///< stretched over it; 255: reflects all light
  int led = 0;                                    ///< code that lights it; 0: none
};

/// Where a ray meets a solid.
struct SolidHit {
  double distance = 0.0;                             ///< in lengths of the ray's direction
  Vector3<double> normal = Vector3<double>::Zero();  ///< (3) unit vector, in the link
};

/// A body of any shape, of one brightness.
struct Solid {
  std::string link = {};  ///< that carries it; empty: the base
  Vector3<double> low =
      Vector3<double>::Zero();  ///< (3) corner of the box about it, in the link, metres
  Vector3<double> high = Vector3<double>::Zero();  ///< (3) the other corner
  double albedo = 0.5;                             ///< reflected share of the light, [0, 1]
  /// The first point on a ray from an origin (3) in a direction (3), both in the link.
  std::function<std::optional<SolidHit>(const Vector3<double>& origin,
                                        const Vector3<double>& direction)>
      cast = {};
};

/// Light from everywhere, and from one lamp.
struct Light {
  double ambient = 0.4;                     ///< on every surface
  double lamp = 1.2;                        ///< on a surface that faces the lamp, near to it
  Vector3<double> position{0.5, 0.8, 2.5};  ///< of the lamp in the base, metres
  double reach = 2.0;                       ///< distance of half its strength, metres
};

/// Everything there is to see.
struct Scene {
  std::vector<Patch> patches = {};
  std::vector<Solid> solids = {};
  Light light = {};
  double background = 0.3;  ///< brightness where there is nothing, [0, 1]
};

/// The pose of a patch that faces in a direction.
/// @param centre  (3) metres, in the link
/// @param front   (3) direction of its front, in the link; any length but zero
/// @param down    (3) direction of its picture's lower edge, in the link, approximate
[[nodiscard]] Pose<double> facing(const Vector3<double>& centre, const Vector3<double>& front,
                                  const Vector3<double>& down = {0.0, 0.0, -1.0});

/// Adds the six sides of a box.
/// @param link_T_box  pose of its middle, metres
/// @param size        (3) along the axes of the box, metres
void add_box(Scene& scene, const std::string& link, const Pose<double>& link_T_box,
             const Vector3<double>& size, double albedo = 0.4);

/// Adds a board with a picture, such as tags; the board ends at the picture's edge.
/// @param link_T_corner  frame in the upper left corner of the picture: x right, y down, z into it
/// @param width          of the picture, metres
void add_picture(Scene& scene, const std::string& link, const Pose<double>& link_T_corner,
                 std::shared_ptr<const GrayImage> picture, double width);

/// Adds a checkerboard with a white margin of one square.
/// @param link_T_board   frame in its first inner corner: x along columns, y along rows, z into it
/// @param columns, rows  inner corners
/// @param square         size of a square, metres
/// @throws std::invalid_argument  if there are no inner corners or a square has no size
void add_checkerboard(Scene& scene, const std::string& link, const Pose<double>& link_T_board,
                      int columns, int rows, double square);

/// Adds LEDs of the codes 1, 2, ... in the order of the points.
/// @param points  metres, in the link
/// @param front   (3) direction of their light, in the link
/// @param radius  metres
void add_leds(Scene& scene, const std::string& link, const std::vector<Vector3<double>>& points,
              const Vector3<double>& front, double radius = 0.003);

/// Adds an infinite floor.
/// @param height  in the base, metres
void add_ground(Scene& scene, double height = 0.0, double albedo = 0.35);

}  // namespace kinecal
