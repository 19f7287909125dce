// The appearance of a URDF's links: its <visual> elements.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// Shapes of a URDF.
enum class VisualShape {
  box,       ///< about its center
  cylinder,  ///< about its center, along z
  sphere,    ///< about its center
  mesh       ///< of a file
};

/// The appearance of a link, or of a part of it.
struct Visual {
  std::string link;                            ///< its name
  Pose<double> link_T_visual;                  ///< metres
  VisualShape shape = VisualShape::box;        ///< decides which of the numbers below apply
  std::array<double, 3> size{};                ///< of a box, metres
  double radius = 0.0;                         ///< of a cylinder or sphere, metres
  double length = 0.0;                         ///< of a cylinder, metres
  std::string mesh = {};                       ///< as the URDF names it: "package://fetch/base.dae"
  std::array<double, 3> scale{1.0, 1.0, 1.0};  ///< of the mesh
  std::array<double, 4> color{0.7, 0.7, 0.7, 1.0};  ///< red, green, blue and opacity, 0 to 1
};

/// Elements of a link that have shapes.
enum class ShapeElement { visual, collision };

/// The visuals of all links, in text order.  Skips those that cannot be drawn, with a warning.
/// @param text               the URDF, UTF-8
/// @param name_for_messages  name of the text in messages: its file
/// @param element            <visual>, or <collision>: shapes that are simpler, without colors
/// @throws InputError  "file:line: message" if the text is not a URDF
[[nodiscard]] std::vector<Visual> visuals(const std::string& text,
                                          const std::string& name_for_messages,
                                          Diagnostics& diagnostics,
                                          ShapeElement element = ShapeElement::visual);

}  // namespace kinecal
