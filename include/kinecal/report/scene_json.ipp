// Writing a scene as JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "kinecal/report/json.hpp"
#include "kinecal/report/scene_json.hpp"
#include "kinecal/report/scene_pieces.ipp"

namespace kinecal {

namespace detail {

[[nodiscard]] inline std::string scene_json(const SceneVisual& of) {
  const Visual& visual = of.visual;
  std::string shape;
  switch (visual.shape) {
    case VisualShape::box:
      shape = fmt::format(R"("kind":"box","size":{})", numbers_json(visual.size, kLengthDigits));
      break;
    case VisualShape::cylinder:
      shape = fmt::format(R"("kind":"cylinder","radius":{},"length":{})",
                          short_number(visual.radius, kLengthDigits),
                          short_number(visual.length, kLengthDigits));
      break;
    case VisualShape::sphere:
      shape =
          fmt::format(R"("kind":"sphere","radius":{})", short_number(visual.radius, kLengthDigits));
      break;
    case VisualShape::mesh:
      if (of.mesh < 0) return {};
      shape = fmt::format(R"("kind":"mesh","mesh":{},"scale":{})", of.mesh,
                          numbers_json(visual.scale, kAngleDigits));
  }
  const auto& [r, g, b, opacity] = visual.color;
  return fmt::format(R"({{{},"pose":{},"color":{}}})", shape, pose_json(visual.link_T_visual),
                     numbers_json(ScenePoint{r, g, b}, 3));
}

[[nodiscard]] inline std::string scene_json(const SceneLink& link) {
  const std::string visuals =
      compact_list(link.visuals, [](const SceneVisual& of) { return scene_json(of); });
  return fmt::format(R"({{"name":{}{}}})", html_json_string(link.name),
                     visuals == "[]" ? "" : R"(,"visuals":)" + visuals);
}

[[nodiscard]] inline std::string scene_json(const char* key,
                                            const std::optional<SceneCorrection>& of) {
  if (!of) return {};
  const bool models =
      std::any_of(of->model.begin(), of->model.end(), [](double value) { return value != 0.0; });
  return fmt::format(R"(,"{}":{{"t":{},"r":{},"offset":{}{}}})", key,
                     numbers_json(of->t, kAngleDigits), numbers_json(of->r, kAngleDigits),
                     short_number(of->offset, kAngleDigits),
                     models ? R"(,"model":)" + numbers_json(of->model, kAngleDigits) : "");
}

[[nodiscard]] inline std::string scene_json(const SceneJoint& joint) {
  return fmt::format(
      R"({{"name":{},"type":"{}","parent":{},"child":{},"origin":{},"axis":{},"drive":[{},{},{}]{}{}{}}})",
      html_json_string(joint.name), to_string(joint.type), joint.parent, joint.child,
      pose_json(joint.origin), numbers_json(joint.axis, kAngleDigits), joint.drive,
      short_number(joint.multiplier, kAngleDigits), short_number(joint.offset, kAngleDigits),
      scene_json("before", joint.before), scene_json("after", joint.after),
      joint.is_virtual ? R"(,"virtual":true)" : "");
}

[[nodiscard]] inline std::string scene_json(const Mesh& mesh) {
  return fmt::format(R"({{"vertices":"{}","triangles":"{}"}})", base64_of(mesh.vertices),
                     base64_of(mesh.triangles));
}

[[nodiscard]] inline std::string scene_json(const char* key, const std::optional<ScenePair>& pair) {
  if (!pair) return {};
  return fmt::format(R"(,"{}":[{},{}])", key, numbers_json((*pair)[0], kLengthDigits),
                     numbers_json((*pair)[1], kLengthDigits));
}

[[nodiscard]] inline std::string scene_json(const SceneFeature& feature) {
  return fmt::format(R"({{"block":{},"name":{}{}{}{}}})", feature.block,
                     html_json_string(feature.name), scene_json("before", feature.before),
                     scene_json("after", feature.after),
                     feature.error.empty() ? "" : R"(,"error":)" + html_json_string(feature.error));
}

[[nodiscard]] inline std::string scene_json(const SceneSample& sample) {
  return fmt::format(
      R"({{"number":{},"source":{},"bad":{}{},"q":{}{},"features":{}}})", sample.number,
      html_json_string(sample.source), sample.bad,
      sample.note.empty() ? "" : R"(,"note":)" + html_json_string(sample.note),
      numbers_json(sample.q, kAngleDigits),
      sample.cloud.empty() ? ""
                           : fmt::format(R"(,"cloud":"{}","cloud_link":{})",
                                         base64_of(sample.cloud), sample.cloud_link),
      compact_list(sample.features, [](const SceneFeature& of) { return scene_json(of); }));
}

[[nodiscard]] inline std::string scene_json(const SceneCamera& camera) {
  const auto pixels = [](double value) { return short_number(value, 3); };
  return fmt::format(
      R"({{"name":{},"link":{},"pose":[0,0,0,0,0,0,1],"width":{},"height":{},"fx":{},"fy":{},"cx":{},"cy":{}}})",
      html_json_string(camera.name), camera.link, pixels(camera.width), pixels(camera.height),
      pixels(camera.fx), pixels(camera.fy), pixels(camera.cx), pixels(camera.cy));
}

/// Points in metres, errors in millimetres.
[[nodiscard]] inline std::string workspace_json(const RobotScene& scene) {
  if (scene.workspace.empty()) return {};
  const auto point = [](const std::array<double, 4>& of) {
    return fmt::format("[{},{},{},{}]", short_number(of[0], 3), short_number(of[1], 3),
                       short_number(of[2], 3), short_number(1e3 * of[3], 4));
  };
  return R"(,"workspace":{"unit":"mm","points":)" + compact_list(scene.workspace, point) + "}";
}

}  // namespace detail

KINECAL_INLINE std::string scene_json(const RobotScene& scene) {
  const auto item = [](const auto& of) { return detail::scene_json(of); };
  std::string json = fmt::format(R"({{"base":{},"links":{},"joints":{})", scene.base,
                                 detail::compact_list(scene.links, item),
                                 detail::compact_list(scene.joints, item));
  json += R"(,"meshes":)" + detail::compact_list(scene.meshes, item);
  json += R"(,"names":)" + detail::compact_list(scene.names, detail::html_json_string);
  json += R"(,"samples":)" + detail::compact_list(scene.samples, item);
  json += R"(,"blocks":)" + detail::compact_list(scene.blocks, detail::html_json_string);
  json += R"(,"cameras":)" + detail::compact_list(scene.cameras, item);
  json += detail::workspace_json(scene);
  if (!scene.thinned.empty()) {
    json += R"(,"thinned":)" + detail::html_json_string(scene.thinned);
  }
  return json + "}";
}

}  // namespace kinecal
