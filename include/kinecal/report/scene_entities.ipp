// The entities of a scene as JSON: shapes of links, points and lines between them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/report/scene_pieces.ipp"

namespace kinecal::detail {

inline constexpr int kEntityDigits = 7;  ///< 0.1 micrometres: people look at differences

using SceneColor = std::array<double, 4>;

inline constexpr SceneColor kGhost = {0.55, 0.6, 0.7, 0.3};       ///< before
inline constexpr SceneColor kMeasured = {0.1, 0.7, 0.3, 1.0};     ///< points after
inline constexpr SceneColor kPredicted = {0.95, 0.55, 0.1, 1.0};  ///< the same
inline constexpr SceneColor kBad = {0.9, 0.15, 0.15, 1.0};        ///< of a sample that does not fit

// There are many of these: fields that are given to Json in braces take twice as long.
[[nodiscard]] inline Json xyz_json(double x, double y, double z) {
  return Json::object_t{{"x", rounded(x, kEntityDigits)},
                        {"y", rounded(y, kEntityDigits)},
                        {"z", rounded(z, kEntityDigits)}};
}
[[nodiscard]] inline Json xyz_json(const ScenePoint& p) {
  return xyz_json(p[0], p[1], p[2]);
}

[[nodiscard]] inline Json quaternion_json(const Matrix3<double>& rotation) {
  const Eigen::Vector4d q = quaternion(rotation).normalized();
  return Json::object_t{{"x", rounded(q(0), 9)},
                        {"y", rounded(q(1), 9)},
                        {"z", rounded(q(2), 9)},
                        {"w", rounded(q(3), 9)}};
}

[[nodiscard]] inline Json entity_pose(const Pose<double>& pose) {
  const Vector3<double>& p = pose.translation;
  return {{"position", xyz_json(p.x(), p.y(), p.z())},
          {"orientation", quaternion_json(pose.rotation)}};
}

[[nodiscard]] inline Json color_json(const SceneColor& color) {
  return Json::object_t{{"r", rounded(color[0], 3)},
                        {"g", rounded(color[1], 3)},
                        {"b", rounded(color[2], 3)},
                        {"a", rounded(color[3], 3)}};
}

[[nodiscard]] inline Json time_json(std::int64_t nanoseconds) {
  constexpr std::int64_t kSecond = 1000000000;
  return {{"sec", nanoseconds / kSecond}, {"nsec", nanoseconds % kSecond}};
}

/// The shapes drawn in one frame.
class SceneEntity {
 public:
  SceneEntity(std::string id, std::string frame) : id_(std::move(id)), frame_(std::move(frame)) {}

  [[nodiscard]] bool empty() const {
    return cubes_.empty() && spheres_.empty() && cylinders_.empty() && lines_.empty() &&
           triangles_.empty() && texts_.empty();
  }

  /// @param color  replaces its own color unless null
  void add(const SceneVisual& of, const std::vector<Mesh>& meshes, const SceneColor* color) {
    const Visual& visual = of.visual;
    const Json pose = entity_pose(visual.link_T_visual),
               paint = color_json(color == nullptr ? visual.color : *color);
    const double d = 2.0 * visual.radius;
    switch (visual.shape) {
      case VisualShape::box:
        cubes_.push_back({{"pose", pose}, {"size", xyz_json(visual.size)}, {"color", paint}});
        break;
      case VisualShape::sphere:
        spheres_.push_back({{"pose", pose}, {"size", xyz_json(d, d, d)}, {"color", paint}});
        break;
      case VisualShape::cylinder:
        cylinders_.push_back({{"pose", pose},
                              {"size", xyz_json(d, d, visual.length)},
                              {"bottom_scale", 1},
                              {"top_scale", 1},
                              {"color", paint}});
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
    spheres_.push_back({{"pose", entity_pose(pose)},
                        {"size", xyz_json(diameter, diameter, diameter)},
                        {"color", color_json(color)}});
  }

  /// Lines between the two points of each pair.
  void add_lines(const std::vector<ScenePair>& pairs, double pixels, const SceneColor& color) {
    if (pairs.empty()) return;
    Json points = Json::array();
    for (const auto& [from, to] : pairs) {
      points.push_back(xyz_json(from));
      points.push_back(xyz_json(to));
    }
    constexpr int kLineList = 2;
    lines_.push_back({{"type", kLineList},
                      {"pose", entity_pose({})},
                      {"thickness", rounded(pixels, 1)},
                      {"scale_invariant", true},
                      {"points", std::move(points)},
                      {"color", color_json(color)},
                      {"colors", Json::array()},
                      {"indices", Json::array()}});
  }

  void add_text(const std::string& text, const Vector3<double>& place, const SceneColor& color) {
    Pose<double> pose;
    pose.translation = place;
    texts_.push_back({{"pose", entity_pose(pose)},
                      {"billboard", true},
                      {"font_size", 14},
                      {"scale_invariant", true},
                      {"color", color_json(color)},
                      {"text", text}});
  }

  /// Its shapes are moved into the result.
  [[nodiscard]] Json json(std::int64_t time) && {
    return {{"timestamp", time_json(time)},
            {"frame_id", frame_},
            {"id", id_},
            {"lifetime", time_json(0)},
            {"frame_locked", true},
            {"metadata", Json::array()},
            {"arrows", Json::array()},
            {"cubes", std::move(cubes_)},
            {"spheres", std::move(spheres_)},
            {"cylinders", std::move(cylinders_)},
            {"lines", std::move(lines_)},
            {"triangles", std::move(triangles_)},
            {"texts", std::move(texts_)},
            {"models", Json::array()}};
  }

 private:
  void add_mesh(const Mesh& mesh, const std::array<double, 3>& scale, const Json& pose,
                const Json& paint) {
    Json points = Json::array();
    for (std::size_t v = 0; v < mesh.num_vertices(); ++v) {
      const float* p = &mesh.vertices[3 * v];
      points.push_back(xyz_json(p[0] * scale[0], p[1] * scale[1], p[2] * scale[2]));
    }
    triangles_.push_back({{"pose", pose},
                          {"points", std::move(points)},
                          {"color", paint},
                          {"colors", Json::array()},
                          {"indices", mesh.triangles}});
  }

  std::string id_, frame_;
  Json cubes_ = Json::array(), spheres_ = Json::array(), cylinders_ = Json::array(),
       lines_ = Json::array(), triangles_ = Json::array(), texts_ = Json::array();
};

[[nodiscard]] inline std::string update_text(std::vector<SceneEntity> entities, std::int64_t time) {
  Json all = Json::array();
  for (SceneEntity& entity : entities) all.push_back(std::move(entity).json(time));
  return json_text({{"deletions", Json::array()}, {"entities", std::move(all)}});
}

}  // namespace kinecal::detail
