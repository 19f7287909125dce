// Writing a scene as MCAP.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/scene_mcap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/bags/mcap/write_mcap.hpp"
#include "kinecal/files/json/json_text.hpp"
#include "kinecal/report/scene_pieces.ipp"

namespace kinecal {

namespace detail {
namespace {

// The entities of a scene as JSON: shapes of links, points and lines between them.

constexpr int kEntityDigits = 7;  ///< 0.1 micrometres: people look at differences

using SceneColor = std::array<double, 4>;

constexpr SceneColor kGhost = {0.55, 0.6, 0.7, 0.3};       ///< before
constexpr SceneColor kMeasured = {0.1, 0.7, 0.3, 1.0};     ///< points after
constexpr SceneColor kPredicted = {0.95, 0.55, 0.1, 1.0};  ///< the same
constexpr SceneColor kBad = {0.9, 0.15, 0.15, 1.0};        ///< of a sample that does not fit

// There are many of these: fields that are given to Json in braces take twice as long.
[[nodiscard]] Json xyz_json(double x, double y, double z) {
  return Json::object_t{{"x", rounded(x, kEntityDigits)},
                        {"y", rounded(y, kEntityDigits)},
                        {"z", rounded(z, kEntityDigits)}};
}
[[nodiscard]] Json xyz_json(const ScenePoint& p) {
  return xyz_json(p[0], p[1], p[2]);
}

[[nodiscard]] Json quaternion_json(const Matrix3<double>& rotation) {
  const Eigen::Vector4d q = quaternion(rotation).normalized();
  return Json::object_t{{"x", rounded(q(0), 9)},
                        {"y", rounded(q(1), 9)},
                        {"z", rounded(q(2), 9)},
                        {"w", rounded(q(3), 9)}};
}

[[nodiscard]] Json entity_pose(const Pose<double>& pose) {
  const Vector3<double>& p = pose.translation;
  return {{"position", xyz_json(p.x(), p.y(), p.z())},
          {"orientation", quaternion_json(pose.rotation)}};
}

[[nodiscard]] Json color_json(const SceneColor& color) {
  return Json::object_t{{"r", rounded(color[0], 3)},
                        {"g", rounded(color[1], 3)},
                        {"b", rounded(color[2], 3)},
                        {"a", rounded(color[3], 3)}};
}

[[nodiscard]] Json time_json(std::int64_t nanoseconds) {
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

[[nodiscard]] std::string update_text(std::vector<SceneEntity> entities, std::int64_t time) {
  Json all = Json::array();
  for (SceneEntity& entity : entities) all.push_back(std::move(entity).json(time));
  return json_text({{"deletions", Json::array()}, {"entities", std::move(all)}});
}

// JSON schemas of the messages that viewers draw: foxglove.FrameTransforms and
// foxglove.SceneUpdate.
// Source: the schemas of Foxglove, by their names of fields.

/// Names of fields and their schemas.
using SchemaFields = std::vector<std::pair<std::string, Json>>;

[[nodiscard]] Json schema_of(const char* type) {
  return {{"type", type}};
}

[[nodiscard]] Json schema_object(std::string_view title, const SchemaFields& fields) {
  Json properties = Json::object();
  for (const auto& [name, schema] : fields) properties[name] = schema;
  return {{"title", title}, {"type", "object"}, {"properties", std::move(properties)}};
}

[[nodiscard]] Json schema_list(const Json& item) {
  return {{"type", "array"}, {"items", item}};
}

const Json kNumberSchema = schema_of("number"), kTextSchema = schema_of("string"),
           kIntegerSchema = schema_of("integer"), kFlagSchema = schema_of("boolean");

/// Of a point in time or of a duration: seconds and nanoseconds.
[[nodiscard]] Json time_schema(std::string_view title) {
  const Json fraction = {{"type", "integer"}, {"minimum", 0}, {"maximum", 999999999}};
  return schema_object(title, {{"sec", kIntegerSchema}, {"nsec", fraction}});
}

[[nodiscard]] Json vector_schema(std::string_view title) {
  return schema_object(title, {{"x", kNumberSchema}, {"y", kNumberSchema}, {"z", kNumberSchema}});
}

[[nodiscard]] Json quaternion_schema() {
  return schema_object(
      "foxglove.Quaternion",
      {{"x", kNumberSchema}, {"y", kNumberSchema}, {"z", kNumberSchema}, {"w", kNumberSchema}});
}

[[nodiscard]] Json pose_schema() {
  return schema_object("foxglove.Pose", {{"position", vector_schema("foxglove.Vector3")},
                                         {"orientation", quaternion_schema()}});
}

[[nodiscard]] Json color_schema() {
  return schema_object(
      "foxglove.Color",
      {{"r", kNumberSchema}, {"g", kNumberSchema}, {"b", kNumberSchema}, {"a", kNumberSchema}});
}

[[nodiscard]] Json frame_transforms_schema() {
  const Json transform =
      schema_object("foxglove.FrameTransform", {{"timestamp", time_schema("time")},
                                                {"parent_frame_id", kTextSchema},
                                                {"child_frame_id", kTextSchema},
                                                {"translation", vector_schema("foxglove.Vector3")},
                                                {"rotation", quaternion_schema()}});
  return schema_object("foxglove.FrameTransforms", {{"transforms", schema_list(transform)}});
}

/// Of a shape: its pose, what else it has, and its color.
[[nodiscard]] Json shape_schema(std::string_view title, const SchemaFields& more) {
  SchemaFields fields = {{"pose", pose_schema()}};
  fields.insert(fields.end(), more.begin(), more.end());
  fields.emplace_back("color", color_schema());
  return schema_list(schema_object(title, fields));
}

[[nodiscard]] Json scene_update_schema() {
  const Json size = vector_schema("foxglove.Vector3"),
             points = schema_list(vector_schema("foxglove.Point3")),
             colors = schema_list(color_schema()), indices = schema_list(kIntegerSchema);
  const Json deletion = schema_object(
      "foxglove.SceneEntityDeletion",
      {{"timestamp", time_schema("time")}, {"type", kIntegerSchema}, {"id", kTextSchema}});
  const Json pair =
      schema_object("foxglove.KeyValuePair", {{"key", kTextSchema}, {"value", kTextSchema}});
  const SchemaFields fields = {
      {"timestamp", time_schema("time")},
      {"frame_id", kTextSchema},
      {"id", kTextSchema},
      {"lifetime", time_schema("duration")},
      {"frame_locked", kFlagSchema},
      {"metadata", schema_list(pair)},
      {"arrows", shape_schema("foxglove.ArrowPrimitive", {{"shaft_length", kNumberSchema},
                                                          {"shaft_diameter", kNumberSchema},
                                                          {"head_length", kNumberSchema},
                                                          {"head_diameter", kNumberSchema}})},
      {"cubes", shape_schema("foxglove.CubePrimitive", {{"size", size}})},
      {"spheres", shape_schema("foxglove.SpherePrimitive", {{"size", size}})},
      {"cylinders", shape_schema("foxglove.CylinderPrimitive", {{"size", size},
                                                                {"bottom_scale", kNumberSchema},
                                                                {"top_scale", kNumberSchema}})},
      {"lines", shape_schema("foxglove.LinePrimitive", {{"type", kIntegerSchema},
                                                        {"thickness", kNumberSchema},
                                                        {"scale_invariant", kFlagSchema},
                                                        {"points", points},
                                                        {"colors", colors},
                                                        {"indices", indices}})},
      {"triangles", shape_schema("foxglove.TriangleListPrimitive",
                                 {{"points", points}, {"colors", colors}, {"indices", indices}})},
      {"texts", shape_schema("foxglove.TextPrimitive", {{"billboard", kFlagSchema},
                                                        {"font_size", kNumberSchema},
                                                        {"scale_invariant", kFlagSchema},
                                                        {"text", kTextSchema}})},
      {"models", shape_schema("foxglove.ModelPrimitive", {{"scale", size},
                                                          {"override_color", kFlagSchema},
                                                          {"url", kTextSchema},
                                                          {"media_type", kTextSchema},
                                                          {"data", kTextSchema}})}};
  return schema_object("foxglove.SceneUpdate",
                       {{"deletions", schema_list(deletion)},
                        {"entities", schema_list(schema_object("foxglove.SceneEntity", fields))}});
}

/// The messages of a scene.
class SceneMessages {
 public:
  explicit SceneMessages(const RobotScene& scene) : scene_(scene) {
    set_times();
    std::vector<int> above(scene.links.size(), -1);
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      above[static_cast<std::size_t>(scene.joints[j].child)] = static_cast<int>(j);
    }
    root_ = scene.base;
    for (int j = above_of(above, root_); j >= 0; j = above_of(above, root_)) {
      up_.push_back(j);
      root_ = scene.joints[static_cast<std::size_t>(j)].parent;
      if (up_.size() > scene.joints.size()) break;  // not a tree
    }
  }

  /// Recording time of a sample, nanoseconds.
  [[nodiscard]] std::int64_t time(std::size_t sample) const { return times_[sample]; }

  [[nodiscard]] std::string transforms(std::size_t sample) const {
    const std::span<const double> q = scene_.samples[sample].q;
    Json all = Json::array();
    for (const bool after : {true, false}) {
      for (const SceneJoint& joint : scene_.joints) {
        add_transform(frame(joint.parent, after), frame(joint.child, after),
                      child_in_parent(joint, q, after), times_[sample], all);
      }
    }
    Pose<double> root_T_base;
    for (auto j = up_.rbegin(); j != up_.rend(); ++j) {
      const SceneJoint& joint = scene_.joints[static_cast<std::size_t>(*j)];
      root_T_base = root_T_base * child_in_parent(joint, q, false);
    }
    add_transform(frame(scene_.base, true), frame(root_, false), root_T_base.inverse(),
                  times_[sample], all);
    return json_text({{"transforms", std::move(all)}});
  }

  /// The links; lines from joint to joint if the URDF has no shapes.
  [[nodiscard]] std::string robot(bool after) const {
    std::vector<SceneEntity> entities;
    for (std::size_t i = 0; i < scene_.links.size(); ++i) {
      const std::string name = frame(static_cast<int>(i), after);
      SceneEntity entity(name, name);
      for (const SceneVisual& visual : scene_.links[i].visuals) {
        entity.add(visual, scene_.meshes, after ? nullptr : &kGhost);
      }
      if (!entity.empty()) entities.push_back(std::move(entity));
    }
    if (entities.empty()) {
      for (const SceneJoint& joint : scene_.joints) entities.push_back(bone(joint, after));
    }
    return update_text(std::move(entities), times_.empty() ? 0 : times_.front());
  }

  /// Measured and predicted points.
  [[nodiscard]] std::string errors(std::size_t n, bool after) const {
    constexpr double kDiameter = 0.006, kThickness = 2.0;  // metres, pixels
    const SceneSample& sample = scene_.samples[n];
    const SceneColor& paint = !after ? kGhost : sample.bad ? kBad : kPredicted;
    SceneEntity entity(after ? "errors" : "errors_before", frame(scene_.base, true));
    std::vector<ScenePair> pairs;
    const SceneFeature* worst = nullptr;
    for (const SceneFeature& feature : sample.features) {
      const auto& pair = after ? feature.after : feature.before;
      if (!pair) continue;
      pairs.push_back(*pair);
      entity.add_point((*pair)[0], kDiameter, after ? kMeasured : kGhost);
      entity.add_point((*pair)[1], kDiameter, paint);
      const bool is_worse = worst == nullptr || worst->distance < feature.distance;
      if (feature.distance && feature.block == sample.features.front().block && is_worse) {
        worst = &feature;
      }
    }
    entity.add_lines(pairs, kThickness, paint);
    if (after) {
      std::string text = fmt::format("sample {}", sample.number);
      if (worst != nullptr) text += fmt::format(": {} is {} off", worst->name, worst->error);
      if (sample.bad) text += (sample.left_out ? "\nleft out: " : "\n") + sample.note;
      entity.add_text(text, Vector3<double>(0.0, 0.0, kTextHeight), paint);
    }
    return update_text({std::move(entity)}, times_[n]);
  }

 private:
  static constexpr double kTextHeight = 1.6;  ///< above the base, metres

  [[nodiscard]] static int above_of(const std::vector<int>& above, int link) {
    return above[static_cast<std::size_t>(link)];
  }

  /// The stamps of the samples if all have one, in their order.
  void set_times() {
    constexpr std::int64_t kSecond = 1000000000;
    bool recorded = true;
    for (const SceneSample& sample : scene_.samples) {
      const std::int64_t stamp = sample.stamp.value_or(std::chrono::nanoseconds(-1)).count();
      recorded = recorded && stamp >= (times_.empty() ? 0 : times_.back());
      times_.push_back(stamp);
    }
    for (std::size_t i = 0; i < times_.size() && !recorded; ++i) {
      times_[i] = static_cast<std::int64_t>(i + 1) * kSecond;
    }
  }

  [[nodiscard]] std::string frame(int link, bool after) const {
    const std::string& name = scene_.links[static_cast<std::size_t>(link)].name;
    return after ? name : "before/" + name;
  }

  static void add_transform(const std::string& parent, const std::string& child,
                            const Pose<double>& pose, std::int64_t time, Json& all) {
    const Vector3<double>& t = pose.translation;
    all.push_back({{"timestamp", time_json(time)},
                   {"parent_frame_id", parent},
                   {"child_frame_id", child},
                   {"translation", xyz_json(t.x(), t.y(), t.z())},
                   {"rotation", quaternion_json(pose.rotation)}});
  }

  [[nodiscard]] SceneEntity bone(const SceneJoint& joint, bool after) const {
    constexpr double kThickness = 4.0;  // pixels
    constexpr SceneColor kBone = {0.3, 0.5, 0.8, 1.0};
    SceneEntity entity(frame(joint.child, after), frame(joint.parent, after));
    const Vector3<double>& t = joint.origin.translation;
    entity.add_lines({{ScenePoint{}, ScenePoint{t.x(), t.y(), t.z()}}}, kThickness,
                     after ? kBone : kGhost);
    return entity;
  }

  const RobotScene& scene_;
  std::vector<std::int64_t> times_;  ///< of each sample
  int root_ = 0;                     ///< the topmost link
  std::vector<int> up_;              ///< joints from the base to it
};

}  // namespace
}  // namespace detail

void write_scene(const RobotScene& scene, std::ostream& out, Compression compression) {
  McapWriter writer(out, {.compression = compression, .json = true});
  const auto add = [&](const char* name, const char* type, const std::string& schema) {
    BagTopic topic;
    topic.name = name;
    topic.type = type;
    topic.definition = schema;
    return writer.add_topic(topic);
  };
  const auto put = [&](std::uint16_t topic, std::int64_t time, const std::string& json) {
    writer.write(topic, time, {reinterpret_cast<const std::byte*>(json.data()), json.size()});
  };
  constexpr const char* kUpdate = "foxglove.SceneUpdate";
  const std::string schema = detail::json_text(detail::scene_update_schema());
  const auto transforms = add("transforms", "foxglove.FrameTransforms",
                              detail::json_text(detail::frame_transforms_schema()));
  const auto robot = add("robot", kUpdate, schema), ghost = add("robot_before", kUpdate, schema),
             errors = add("errors", kUpdate, schema), old = add("errors_before", kUpdate, schema);
  const detail::SceneMessages messages(scene);
  for (std::size_t i = 0; i < scene.samples.size(); ++i) {
    const std::int64_t time = messages.time(i);
    put(transforms, time, messages.transforms(i));
    if (i == 0) {
      put(robot, time, messages.robot(true));
      put(ghost, time, messages.robot(false));
    }
    put(errors, time, messages.errors(i, true));
    put(old, time, messages.errors(i, false));
  }
  writer.close();
}

}  // namespace kinecal
