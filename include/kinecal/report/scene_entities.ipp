// The entities of a scene as JSON: shapes of links, points and lines between them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/report/scene_pieces.ipp"

namespace kinecal::detail {

inline constexpr int kEntityDigits = 7;  ///< 0.1 micrometres: differences are looked at

using SceneColor = std::array<double, 4>;

inline constexpr SceneColor kGhost = {0.55, 0.6, 0.7, 0.3};       ///< before
inline constexpr SceneColor kMeasured = {0.1, 0.7, 0.3, 1.0};     ///< points after
inline constexpr SceneColor kPredicted = {0.95, 0.55, 0.1, 1.0};  ///< the same
inline constexpr SceneColor kBad = {0.9, 0.15, 0.15, 1.0};        ///< of a sample that does not fit

[[nodiscard]] inline std::string xyz_json(double x, double y, double z) {
  return fmt::format(R"({{"x":{},"y":{},"z":{}}})", short_number(x, kEntityDigits),
                     short_number(y, kEntityDigits), short_number(z, kEntityDigits));
}
[[nodiscard]] inline std::string xyz_json(const ScenePoint& p) {
  return xyz_json(p[0], p[1], p[2]);
}

[[nodiscard]] inline std::string quaternion_json(const Matrix3<double>& rotation) {
  const Eigen::Vector4d q = quaternion(rotation).normalized();
  return fmt::format(R"({{"x":{},"y":{},"z":{},"w":{}}})", short_number(q(0), 9),
                     short_number(q(1), 9), short_number(q(2), 9), short_number(q(3), 9));
}

[[nodiscard]] inline std::string entity_pose(const Pose<double>& pose) {
  const Vector3<double>& p = pose.translation;
  return fmt::format(R"("pose":{{"position":{},"orientation":{}}})", xyz_json(p.x(), p.y(), p.z()),
                     quaternion_json(pose.rotation));
}

[[nodiscard]] inline std::string color_json(const SceneColor& color) {
  return fmt::format(R"("color":{{"r":{},"g":{},"b":{},"a":{}}})", short_number(color[0], 3),
                     short_number(color[1], 3), short_number(color[2], 3),
                     short_number(color[3], 3));
}

[[nodiscard]] inline std::string time_json(std::int64_t nanoseconds) {
  constexpr std::int64_t kSecond = 1000000000;
  return fmt::format(R"({{"sec":{},"nsec":{}}})", nanoseconds / kSecond, nanoseconds % kSecond);
}

/// What is drawn in one frame.
class SceneEntity {
 public:
  SceneEntity(std::string id, std::string frame) : id_(std::move(id)), frame_(std::move(frame)) {}

  [[nodiscard]] bool empty() const {
    return (cubes_ + spheres_ + cylinders_ + lines_ + triangles_ + texts_).empty();
  }

  /// @param color  in place of its own, if it is not null
  void add(const SceneVisual& of, const std::vector<Mesh>& meshes, const SceneColor* color) {
    const Visual& visual = of.visual;
    const std::string pose = entity_pose(visual.link_T_visual),
                      paint = color_json(color == nullptr ? visual.color : *color);
    const double d = 2.0 * visual.radius;
    switch (visual.shape) {
      case VisualShape::box:
        append(cubes_, fmt::format(R"({{{},"size":{},{}}})", pose, xyz_json(visual.size), paint));
        break;
      case VisualShape::sphere:
        append(spheres_, fmt::format(R"({{{},"size":{},{}}})", pose, xyz_json(d, d, d), paint));
        break;
      case VisualShape::cylinder:
        append(cylinders_, fmt::format(R"({{{},"size":{},"bottom_scale":1,"top_scale":1,{}}})",
                                       pose, xyz_json(d, d, visual.length), paint));
        break;
      case VisualShape::mesh:
        if (of.mesh >= 0) {
          add_mesh(meshes[static_cast<std::size_t>(of.mesh)], visual.scale, pose, paint);
        }
    }
  }

  void add_point(const ScenePoint& p, double diameter, const SceneColor& color) {
    Pose<double> pose;
    pose.translation = Vector3<double>(p[0], p[1], p[2]);
    append(spheres_, fmt::format(R"({{{},"size":{},{}}})", entity_pose(pose),
                                 xyz_json(diameter, diameter, diameter), color_json(color)));
  }

  /// Lines between the two points of each pair.
  void add_lines(const std::vector<ScenePair>& pairs, double pixels, const SceneColor& color) {
    if (pairs.empty()) return;
    std::string points;
    for (const auto& [from, to] : pairs) {
      append(points, xyz_json(from));
      append(points, xyz_json(to));
    }
    constexpr int kLineList = 2;
    append(lines_, fmt::format(R"({{"type":{},{},"thickness":{},"scale_invariant":true,)"
                               R"("points":[{}],{},"colors":[],"indices":[]}})",
                               kLineList, entity_pose({}), short_number(pixels, 1), points,
                               color_json(color)));
  }

  void add_text(const std::string& text, const Vector3<double>& place, const SceneColor& color) {
    Pose<double> pose;
    pose.translation = place;
    append(texts_, fmt::format(R"({{{},"billboard":true,"font_size":14,"scale_invariant":true,)"
                               R"({},"text":{}}})",
                               entity_pose(pose), color_json(color), html_json_string(text)));
  }

  [[nodiscard]] std::string json(std::int64_t time) const {
    return fmt::format(
        R"({{"timestamp":{},"frame_id":{},"id":{},"lifetime":{{"sec":0,"nsec":0}},)"
        R"("frame_locked":true,"metadata":[],"arrows":[],"cubes":[{}],"spheres":[{}],)"
        R"("cylinders":[{}],"lines":[{}],"triangles":[{}],"texts":[{}],"models":[]}})",
        time_json(time), html_json_string(frame_), html_json_string(id_), cubes_, spheres_,
        cylinders_, lines_, triangles_, texts_);
  }

 private:
  static void append(std::string& list, const std::string& item) {
    if (!list.empty()) list += ',';
    list += item;
  }

  void add_mesh(const Mesh& mesh, const std::array<double, 3>& scale, const std::string& pose,
                const std::string& paint) {
    std::string points, indices;
    for (std::size_t v = 0; v < mesh.num_vertices(); ++v) {
      const float* p = &mesh.vertices[3 * v];
      append(points, xyz_json(p[0] * scale[0], p[1] * scale[1], p[2] * scale[2]));
    }
    for (const std::uint32_t vertex : mesh.triangles) append(indices, std::to_string(vertex));
    append(triangles_, fmt::format(R"({{{},"points":[{}],{},"colors":[],"indices":[{}]}})", pose,
                                   points, paint, indices));
  }

  std::string id_, frame_;
  std::string cubes_, spheres_, cylinders_, lines_, triangles_, texts_;
};

[[nodiscard]] inline std::string update_json(const std::vector<SceneEntity>& entities,
                                             std::int64_t time) {
  std::string all;
  for (const SceneEntity& entity : entities) all += (all.empty() ? "" : ",") + entity.json(time);
  return R"({"deletions":[],"entities":[)" + all + "]}";
}

}  // namespace kinecal::detail
