// Entries of a first configuration that several targets share: models, the camera's parameters,
// error blocks, a board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/tools/init/camera_parts.ipp"
#include "kinecal/tools/init/init_answers.hpp"
#include "kinecal/tools/init/init_plan.ipp"

namespace kinecal::detail {

inline void add_chain_model(InitPlan& plan, const std::string& why, const std::string& name,
                            const std::string& link) {
  plan.models.push_back({why, name, {{"type", "chain3d"}, {"frame", name_to_yaml(link)}}});
}

inline void add_camera_model(InitPlan& plan, const InitAnswers& answers) {
  const bool depth = answers.camera_type == "camera3d";
  plan.models.push_back({depth ? "A depth camera: points in metres, in its optical frame."
                               : "A camera: pixels.  In its frame z points ahead and y down.",
                         answers.camera_name,
                         {{"type", answers.camera_type}, {"frame", name_to_yaml(answers.camera)}}});
}

/// Frees the camera's parameters.
/// @param floor_only  only those that the floor determines
inline void free_camera(InitPlan& plan, const InitAnswers& answers, bool floor_only) {
  const auto add = [&](const char* part, const std::string& why) {
    plan.free_params.push_back({why, answers.camera_name + "_" + part, {}});
  };
  if (!floor_only) {
    add("fx",
        "Focal lengths and image centre, relative to the driver's values: 0.01 is one percent.");
    for (const char* part : {"fy", "cx", "cy"}) add(part, "");
  }
  if (answers.camera_type != "camera3d") return;
  add("z_offset", "Depth: z = (1 + z_scaling) * (measured z + z_offset), z_offset in metres.");
  add("z_scaling", "");
}

/// Compares the points seen by the camera with those of a model.
inline void add_hand_eye(InitPlan& plan, const InitAnswers& answers) {
  const std::string model = holder_of(answers);
  InitEntry block{"", "hand_eye", {}};
  if (answers.camera_type == "camera3d") {
    block.why = "The camera and model '" + model +
                "' observe the same points, in the same order.  sigma is the camera's accuracy for "
                "one point, in metres: 0.003 is a guess, write yours.";
    block.fields = {{"type", "chain3d_to_chain3d"},
                    {"model_a", name_to_yaml(answers.camera_name)},
                    {"model_b", name_to_yaml(model)},
                    {"sigma", "0.003"}};
  } else {
    block.why = "The camera sees the points of model '" + model +
                "', in the same order.  sigma is its accuracy for one point, in "
                "pixels: 0.5 is a guess, write yours.";
    block.fields = {{"type", "chain3d_to_camera2d"},
                    {"model_3d", name_to_yaml(model)},
                    {"model_2d", name_to_yaml(answers.camera_name)},
                    {"sigma", "0.5"}};
  }
  block.fields.emplace_back("loss", "{type: huber, scale: 3.0}");
  plan.error_blocks.push_back(std::move(block));
}

inline void add_ground(InitPlan& plan, const InitAnswers& answers) {
  plan.error_blocks.push_back({"The floor: a x + b y + c z + d = 0 in link " +
                                   name_to_yaml(answers.base) +
                                   ".  Set d if the origin of this link is not on the floor (0.1 m "
                                   "above it: d: 0.1).  'alone' selects "
                                   "the samples in which only the camera observes.  sigma, the "
                                   "camera's accuracy for one point in metres, is a guess.",
                               "ground_plane",
                               {{"type", "chain3d_to_plane"},
                                {"model", name_to_yaml(answers.camera_name)},
                                {"a", "0.0"},
                                {"b", "0.0"},
                                {"c", "1.0"},
                                {"d", "0.0"},
                                {"samples", "alone"},
                                {"sigma", "0.003"},
                                {"loss", "{type: huber, scale: 3.0}"}}});
}

/// Keeps a frame near zero in the directions that samples do not determine.
inline void keep_near_zero(InitPlan& plan, const std::string& frame, const std::string& why) {
  plan.error_blocks.push_back(
      {why + "  It counts once per sample: with 100 samples, these scales weigh as much as one "
             "measurement with an accuracy of 0.1 m and 6 degrees.",
       "restrict_" + frame,
       {{"type", "outrageous"},
        {"param", name_to_yaml(frame)},
        {"joint_scale", "0.0"},
        {"position_scale", "1.0"},
        {"rotation_scale", "1.0"}}});
}

/// The joint whose frame describes the camera's mount.
/// @throws InputError  if there is no such joint
[[nodiscard]] inline const Joint& require_mount(const Robot& robot, const InitAnswers& answers,
                                                const std::vector<std::string>& others) {
  const Joint* mount = camera_mount(robot, answers.camera, others);
  if (mount == nullptr) {
    throw InputError(
        fmt::format("--camera: no joint that could be corrected belongs to link '{}' alone; choose "
                    "another link, or another --base or --arm",
                    answers.camera));
  }
  return *mount;
}

/// Frees the frame of a board that is in the gripper or fixed in the world.
inline void add_board(InitPlan& plan, const std::string& name, const std::string& link) {
  free_frame(
      plan, name,
      "Where the board is, seen from link " + name_to_yaml(link) +
          ".  The URDF does not contain this frame; it is the frame_id of the board's corners.");
  add_initial_value(plan, name,
                    "Zeros are no guess: kinecal searches for the board.  Should it not find it, "
                    "measure where the board's first corner is in link " +
                        name_to_yaml(link) +
                        " and how the board is turned (x along its rows, y along its columns).");
}

/// Points on a link, or of a board in the target frame on it, that the camera sees.
[[nodiscard]] inline MeasuredTarget seen_by_camera(const InitAnswers& answers,
                                                   const std::string& link) {
  MeasuredTarget seen{answers.base, link, answers.camera};
  seen.target_frame = answers.target_frame;
  seen.is_camera = true;
  seen.has_depth = answers.camera_type == "camera3d";
  return seen;
}

}  // namespace kinecal::detail
