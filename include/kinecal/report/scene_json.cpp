// Writing a scene as JSON.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/scene_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "kinecal/report/scene_pieces.ipp"
#include "kinecal/text/characters.hpp"

namespace kinecal {

namespace detail {
namespace {

[[nodiscard]] Json scene_tree(const SceneVisual& of) {
  const Visual& visual = of.visual;
  Json json;
  switch (visual.shape) {
    case VisualShape::box:
      json = {{"kind", "box"}, {"size", rounded_list(visual.size, kLengthDigits)}};
      break;
    case VisualShape::cylinder:
      json = {{"kind", "cylinder"},
              {"radius", rounded(visual.radius, kLengthDigits)},
              {"length", rounded(visual.length, kLengthDigits)}};
      break;
    case VisualShape::sphere:
      json = {{"kind", "sphere"}, {"radius", rounded(visual.radius, kLengthDigits)}};
      break;
    case VisualShape::mesh:
      json = {
          {"kind", "mesh"}, {"mesh", of.mesh}, {"scale", rounded_list(visual.scale, kAngleDigits)}};
  }
  const auto& [r, g, b, opacity] = visual.color;
  json["pose"] = pose_json(visual.link_T_visual);
  json["color"] = rounded_list(ScenePoint{r, g, b}, 3);
  return json;
}

[[nodiscard]] Json scene_tree(const SceneLink& link) {
  Json json = {{"name", one_line(link.name)}};
  for (const SceneVisual& visual : link.visuals) {
    const bool is_found = visual.visual.shape != VisualShape::mesh || visual.mesh >= 0;
    if (is_found) json["visuals"].push_back(scene_tree(visual));
  }
  return json;
}

[[nodiscard]] Json scene_tree(const SceneCorrection& of) {
  return {{"t", rounded_list(of.t, kAngleDigits)},
          {"r", rounded_list(of.r, kAngleDigits)},
          {"offset", rounded(of.offset, kAngleDigits)}};
}

[[nodiscard]] Json scene_tree(const ScenePair& pair) {
  return Json::array({rounded_list(pair[0], kLengthDigits), rounded_list(pair[1], kLengthDigits)});
}

/// Fields of what is there.
template <class T>
void add_before_after(const std::optional<T>& before, const std::optional<T>& after, Json& json) {
  if (before) json["before"] = scene_tree(*before);
  if (after) json["after"] = scene_tree(*after);
}

[[nodiscard]] Json scene_tree(const SceneJoint& joint) {
  Json json = {{"name", one_line(joint.name)},
               {"type", to_string(joint.type)},
               {"parent", joint.parent},
               {"child", joint.child},
               {"origin", pose_json(joint.origin)},
               {"axis", rounded_list(joint.axis, kAngleDigits)},
               {"drive", Json::array({joint.drive, rounded(joint.multiplier, kAngleDigits),
                                      rounded(joint.offset, kAngleDigits)})}};
  add_before_after(joint.before, joint.after, json);
  if (joint.is_virtual) json["virtual"] = true;
  return json;
}

[[nodiscard]] Json scene_tree(const Mesh& mesh) {
  return {{"vertices", base64_of(mesh.vertices)}, {"triangles", base64_of(mesh.triangles)}};
}

[[nodiscard]] Json scene_tree(const SceneFeature& feature) {
  Json json = {{"block", feature.block}, {"name", one_line(feature.name)}};
  add_before_after(feature.before, feature.after, json);
  if (!feature.error.empty()) json["error"] = feature.error;
  return json;
}

/// In steps of 0.1 mm, or of what 16 bits allow.
[[nodiscard]] Json scene_tree(const SceneCloud& cloud) {
  constexpr double kStep = 1e-4, kMost = 65535.0;
  ScenePoint low = cloud.points.front(), high = low;
  for (const ScenePoint& p : cloud.points) {
    for (std::size_t k = 0; k < p.size(); ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  double widest = *std::max_element(cloud.distances.begin(), cloud.distances.end());
  for (std::size_t k = 0; k < low.size(); ++k) widest = std::max(widest, high[k] - low[k]);
  const double step = std::max(kStep, widest / kMost);
  const auto steps = [&](double length) {
    return static_cast<std::uint16_t>(std::min(std::round(length / step), kMost));
  };
  std::vector<std::uint16_t> numbers;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    for (std::size_t k = 0; k < low.size(); ++k)
      numbers.push_back(steps(cloud.points[i][k] - low[k]));
    numbers.push_back(steps(cloud.distances[i]));
  }
  return {{"low", low}, {"step", step}, {"points", base64_of(numbers)}};
}

[[nodiscard]] Json scene_tree(const SceneSample& sample) {
  Json json = {{"number", sample.number}, {"source", one_line(sample.source)}, {"bad", sample.bad}};
  if (sample.left_out) json["left_out"] = true;
  if (!sample.note.empty()) json["note"] = one_line(sample.note);
  json["q"] = rounded_list(sample.q, kAngleDigits);
  if (!sample.cloud.empty()) {
    json["cloud"] = base64_of(sample.cloud);
    json["cloud_link"] = sample.cloud_link;
  }
  if (!sample.matched_before.points.empty()) {
    json["matched"]["before"] = scene_tree(sample.matched_before);
  }
  if (!sample.matched_after.points.empty()) {
    json["matched"]["after"] = scene_tree(sample.matched_after);
  }
  Json& features = json["features"] = Json::array();
  for (const SceneFeature& feature : sample.features) features.push_back(scene_tree(feature));
  return json;
}

[[nodiscard]] Json scene_tree(const SceneCamera& camera) {
  const auto pixels = [](double value) { return rounded(value, 3); };
  return {{"name", one_line(camera.name)},   {"link", camera.link},
          {"pose", pose_json({})},           {"width", pixels(camera.width)},
          {"height", pixels(camera.height)}, {"fx", pixels(camera.fx)},
          {"fy", pixels(camera.fy)},         {"cx", pixels(camera.cx)},
          {"cy", pixels(camera.cy)}};
}

[[nodiscard]] Json scene_tree(const std::string& name) {
  return one_line(name);
}

template <class Items>
[[nodiscard]] Json scene_list(const Items& items) {
  Json list = Json::array();
  for (const auto& item : items) list.push_back(scene_tree(item));
  return list;
}

/// Points in metres, errors in millimetres.
[[nodiscard]] Json workspace_json(const RobotScene& scene) {
  Json points = Json::array();
  for (const auto& [x, y, z, error] : scene.workspace) {
    points.push_back(
        Json::array({rounded(x, 3), rounded(y, 3), rounded(z, 3), rounded(1e3 * error, 4)}));
  }
  return {{"unit", "mm"}, {"points", std::move(points)}};
}

}  // namespace
}  // namespace detail

std::string scene_json(const RobotScene& scene) {
  using detail::scene_list;
  detail::Json json = {{"base", scene.base},
                       {"links", scene_list(scene.links)},
                       {"joints", scene_list(scene.joints)},
                       {"meshes", scene_list(scene.meshes)},
                       {"names", scene_list(scene.names)},
                       {"samples", scene_list(scene.samples)},
                       {"blocks", scene_list(scene.blocks)},
                       {"cameras", scene_list(scene.cameras)}};
  if (!scene.workspace.empty()) json["workspace"] = detail::workspace_json(scene);
  if (!scene.thinned.empty()) json["thinned"] = scene.thinned;
  return detail::json_in_html(json);
}

}  // namespace kinecal
