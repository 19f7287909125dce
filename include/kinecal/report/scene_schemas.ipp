// JSON schemas of the messages that viewers draw: foxglove.FrameTransforms and
// foxglove.SceneUpdate.
// Source: the schemas of Foxglove, by their names of fields.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/json/json_text.hpp"

namespace kinecal::detail {

/// Names of fields and their schemas.
using SchemaFields = std::vector<std::pair<std::string, Json>>;

[[nodiscard]] inline Json schema_of(const char* type) {
  return {{"type", type}};
}

[[nodiscard]] inline Json schema_object(std::string_view title, const SchemaFields& fields) {
  Json properties = Json::object();
  for (const auto& [name, schema] : fields) properties[name] = schema;
  return {{"title", title}, {"type", "object"}, {"properties", std::move(properties)}};
}

[[nodiscard]] inline Json schema_list(const Json& item) {
  return {{"type", "array"}, {"items", item}};
}

inline const Json kNumberSchema = schema_of("number"), kTextSchema = schema_of("string"),
                  kIntegerSchema = schema_of("integer"), kFlagSchema = schema_of("boolean");

/// Of a point in time or of a duration: seconds and nanoseconds.
[[nodiscard]] inline Json time_schema(std::string_view title) {
  const Json fraction = {{"type", "integer"}, {"minimum", 0}, {"maximum", 999999999}};
  return schema_object(title, {{"sec", kIntegerSchema}, {"nsec", fraction}});
}

[[nodiscard]] inline Json vector_schema(std::string_view title) {
  return schema_object(title, {{"x", kNumberSchema}, {"y", kNumberSchema}, {"z", kNumberSchema}});
}

[[nodiscard]] inline Json quaternion_schema() {
  return schema_object(
      "foxglove.Quaternion",
      {{"x", kNumberSchema}, {"y", kNumberSchema}, {"z", kNumberSchema}, {"w", kNumberSchema}});
}

[[nodiscard]] inline Json pose_schema() {
  return schema_object("foxglove.Pose", {{"position", vector_schema("foxglove.Vector3")},
                                         {"orientation", quaternion_schema()}});
}

[[nodiscard]] inline Json color_schema() {
  return schema_object(
      "foxglove.Color",
      {{"r", kNumberSchema}, {"g", kNumberSchema}, {"b", kNumberSchema}, {"a", kNumberSchema}});
}

[[nodiscard]] inline Json frame_transforms_schema() {
  const Json transform =
      schema_object("foxglove.FrameTransform", {{"timestamp", time_schema("time")},
                                                {"parent_frame_id", kTextSchema},
                                                {"child_frame_id", kTextSchema},
                                                {"translation", vector_schema("foxglove.Vector3")},
                                                {"rotation", quaternion_schema()}});
  return schema_object("foxglove.FrameTransforms", {{"transforms", schema_list(transform)}});
}

/// Of a shape: its pose, what else it has, and its color.
[[nodiscard]] inline Json shape_schema(std::string_view title, const SchemaFields& more) {
  SchemaFields fields = {{"pose", pose_schema()}};
  fields.insert(fields.end(), more.begin(), more.end());
  fields.emplace_back("color", color_schema());
  return schema_list(schema_object(title, fields));
}

[[nodiscard]] inline Json scene_update_schema() {
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

}  // namespace kinecal::detail
