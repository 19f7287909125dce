// Mesh files that tests write.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace kinecal::test {

using Corner = std::array<float, 3>;
using Triangle = std::array<Corner, 3>;

inline void append(std::string& bytes, const void* from, std::size_t size) {
  bytes.append(static_cast<const char*>(from), size);
}

inline std::string binary_stl(const std::vector<Triangle>& triangles) {
  std::string bytes = "solid by a program that does not care";
  bytes.resize(80);
  const auto count = static_cast<std::uint32_t>(triangles.size());
  append(bytes, &count, 4);
  for (const Triangle& triangle : triangles) {
    bytes.append(12, '\0');
    append(bytes, triangle.data(), sizeof triangle);
    bytes.append(2, '\0');
  }
  return bytes;
}

inline std::string text_stl(const std::vector<Triangle>& triangles) {
  std::string text = "solid part\n";
  for (const Triangle& triangle : triangles) {
    text += " facet normal 0 0 1\n  outer loop\n";
    for (const Corner& p : triangle) {
      text += "   vertex " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " +" +
              std::to_string(std::abs(p[2])) + "\n";
    }
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid part\n";
}

/// A tetrahedron: four triangles, four corners.
inline std::vector<Triangle> tetrahedron(float size = 1.0F) {
  const Corner o{0, 0, 0}, x{size, 0, 0}, y{0, size, 0}, z{0, 0, size};
  return {{o, y, x}, {o, x, z}, {o, z, y}, {x, y, z}};
}

/// A ball of 2 n^2 triangles, or nearly.
inline std::vector<Triangle> ball(int n) {
  const auto at = [n](int i, int k) {
    const double up = M_PI * i / n, around = 2.0 * M_PI * (k % n) / n;
    return Corner{static_cast<float>(std::sin(up) * std::cos(around)),
                  static_cast<float>(std::sin(up) * std::sin(around)),
                  static_cast<float>(std::cos(up))};
  };
  std::vector<Triangle> all;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      if (i > 0) all.push_back({at(i, k), at(i + 1, k), at(i, k + 1)});
      if (i + 1 < n) all.push_back({at(i, k + 1), at(i + 1, k), at(i + 1, k + 1)});
    }
  }
  return all;
}

/// A COLLADA file of one triangle (0,0,0) (1,0,0) (0,1,2) in a node that is moved by (0, 0, 3) units.
inline std::string dae(const std::string& unit, const std::string& up) {
  return R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><unit name="x" meter=")" +
         unit + R"("/><up_axis>)" + up + R"(</up_axis></asset>
 <library_geometries><geometry id="g"><mesh>
  <source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 2</float_array>
   <technique_common><accessor source="#pa" count="3" stride="3">
    <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
   </accessor></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
 </mesh></geometry></library_geometries>
 <library_visual_scenes><visual_scene id="s">
  <node id="n"><translate>0 0 3</translate><instance_geometry url="#g"/></node>
 </visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)";
}

}  // namespace kinecal::test
