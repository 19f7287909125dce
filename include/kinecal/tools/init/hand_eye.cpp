// Definitions of hand_eye.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/hand_eye.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/tools/init/hand_eye_columns.ipp"

namespace kinecal {

std::string hand_eye_urdf(bool camera_on_hand) {
  using Names = HandEyeNames;
  return fmt::format(
      R"(<?xml version="1.0"?>
<!-- A robot of which only the poses of the flange are known: the samples have them. -->
<robot name="hand_eye">
  <link name="{0}"/>
  <link name="{1}"/>
  <joint name="{2}" type="floating">
    <parent link="{0}"/>
    <child link="{1}"/>
  </joint>
  <!-- The camera's optical frame: z ahead, x right, y down. -->
  <link name="{3}"/>
  <joint name="{4}" type="fixed">
    <parent link="{5}"/>
    <child link="{3}"/>
    <origin xyz="0 0 0" rpy="0 0 0"/>
  </joint>
</robot>
)",
      Names::kBase, Names::kFlange, Names::kFlangeJoint, Names::kCamera, Names::kCameraJoint,
      camera_on_hand ? Names::kFlange : Names::kBase);
}

std::string hand_eye_pose_config(bool camera_on_hand) {
  using Names = HandEyeNames;
  return fmt::format(
      R"(# Hand-eye calibration from poses of the flange and of an object in the camera.  'kinecal init' wrote
# this first configuration.  Units are metres and radians.
base_link: {base}
max_num_iterations: 1000

models:
 # The camera: poses of the object in it.
 - name: {camera}
   type: chain6d
   frame: {camera}
 # What holds the object.
 - name: {object}
   type: chain6d
   frame: {holder}

free_frames:
 # How the camera is mounted.
 - {{name: {joint}, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}}
 # Where the object is in '{holder}'.
 - {{name: {target}, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}}

free_frames_initial_values:
 # Nobody needs to know it.
 - {{name: {target}, x: 0.0, y: 0.0, z: 0.0, roll: 0.0, pitch: 0.0, yaw: 0.0}}

error_blocks:
 # Both see the same pose.  One over the accuracies of a pose of the object: 1 mm and 5 mrad are a guess,
 # write yours.
 - name: hand_eye
   type: pose_to_pose
   model_a: {camera}
   model_b: {object}
   translation_scale: 1000.0
   rotation_scale: 200.0
   loss: {{type: huber, scale: 3.0}}
)",
      fmt::arg("base", Names::kBase), fmt::arg("camera", Names::kCamera),
      fmt::arg("object", Names::kObject), fmt::arg("joint", Names::kCameraJoint),
      fmt::arg("target", Names::kTarget),
      fmt::arg("holder", camera_on_hand ? Names::kBase : Names::kFlange));
}

std::string hand_eye_columns(const HandEyeTables& tables, const std::string& output_folder) {
  using namespace detail;
  const HandEyeTable poses(tables.poses);
  const PoseColumns columns = pose_columns(poses, tables.form);
  std::string text = fmt::format(
      "# Columns for a hand-eye calibration, proposed by the table's header and values: check "
      "them.\nseparator: {}\nheader: {}\n\nposes:\n  {}:\n    form: {}\n{}    columns: [{}]\n",
      poses.separator(), poses.has_header(), HandEyeNames::kFlangeJoint, columns.form,
      units_text(poses, columns), fmt::join(poses.names(columns.indices), ", "));
  if (tables.inverse) text += "    inverse: true  # of the base in the flange\n";
  if (tables.corners.empty()) return text;
  if (tables.target.empty()) {
    throw InputError(tables.corners + ": needs the table of where the corners are on the board");
  }
  const HandEyeTable corners(tables.corners), target(tables.target);
  const auto path = [&](const std::string& file) {
    const auto folder = std::filesystem::absolute(output_folder.empty() ? "." : output_folder);
    return name_to_yaml(std::filesystem::proximate(file, folder).string());
  };
  const std::vector<int> pixel = corners.find({{"u", "v"}, {"x", "y"}, {"pxu", "pxv"}}, "u and v"),
                         id = corners.find({{"id"}, {"corner"}, {"cornerid"}}, "id"),
                         place = target.find({{"x", "y", "z"}}, "x, y and z"),
                         of_target = target.find({{"id"}, {"corner"}, {"cornerid"}}, "id");
  text += fmt::format(
      "\nobservations:\n"
      " - sensor: {}  # what carries the board: where its corners are\n   frame: {}\n"
      "   table: {}\n   unit: {}\n   points: [[{}]]\n   id_columns: [{}]\n",
      name_to_yaml(tables.holder), HandEyeNames::kTarget, path(tables.target),
      target.is_millimetres(place) ? "millimetres" : "metres", fmt::join(target.names(place), ", "),
      target.names(of_target).front());
  text += fmt::format(
      " - sensor: camera\n   frame: {}\n   table: {}\n   match: {}\n   pixels: [[{}]]\n"
      "   id_columns: [{}]\n",
      HandEyeNames::kCamera, path(tables.corners), common_column(poses, corners),
      fmt::join(corners.names(pixel), ", "), corners.names(id).front());
  return text;
}

}  // namespace kinecal
