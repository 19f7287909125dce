// Entries of a first configuration that several targets have in common: models, the camera's own
// parameters, error blocks, a board.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "kinecal/io/diagnostics.hpp"
#include "kinecal/io/init/init_answers.hpp"
#include "kinecal/io/init/init_plan.hpp"

namespace kinecal::detail {

inline void add_chain_model(InitPlan& plan, const std::string& why, const std::string& name,
                            const std::string& link) {
  plan.models.push_back({why, name, {{"type", "chain3d"}, {"frame", name_to_yaml(link)}}});
}

inline void add_camera_model(InitPlan& plan, const InitAnswers& answers) {
  const bool depth = answers.camera_type == "camera3d";
  plan.models.push_back({depth ? "A depth camera: points in metres, in its optical frame."
                               : "A camera: pixels.  Its frame has z ahead and y down.",
                         answers.camera_name,
                         {{"type", answers.camera_type}, {"frame", name_to_yaml(answers.camera)}}});
}

/// The camera's own parameters.
inline void free_camera(InitPlan& plan, const InitAnswers& answers, bool floor_only) {
  const auto add = [&](const char* part, const std::string& why) {
    plan.free_params.push_back({why, answers.camera_name + "_" + part, {}});
  };
  if (!floor_only) {
    add("fx",
        "Focal lengths and centre of the image, relative to what the driver was told: 0.01 "
        "is one percent.");
    for (const char* part : {"fy", "cx", "cy"}) add(part, "");
  }
  if (answers.camera_type != "camera3d") return;
  add("z_offset",
      "Depth: z = (1 + z_scaling) * (what was measured + z_offset), z_offset in "
      "metres.");
  add("z_scaling", "");
}

/// Compares the camera with a model of points.
inline void add_hand_eye(InitPlan& plan, const InitAnswers& answers, const std::string& model) {
  InitEntry block{"", "hand_eye", {}};
  if (answers.camera_type == "camera3d") {
    block.why = "The camera and model '" + model +
                "' tell of the same points, in the same order.  sigma is how well the camera "
                "measures a point, in metres.";
    block.fields = {{"type", "chain3d_to_chain3d"},
                    {"model_a", name_to_yaml(answers.camera_name)},
                    {"model_b", model},
                    {"sigma", "0.003"}};
  } else {
    block.why = "The camera sees the points of model '" + model +
                "', in the same order.  sigma is how well it sees one, in pixels.";
    block.fields = {{"type", "chain3d_to_camera2d"},
                    {"model_3d", model},
                    {"model_2d", name_to_yaml(answers.camera_name)},
                    {"sigma", "0.5"}};
  }
  block.fields.emplace_back("loss", "{type: huber, scale: 3.0}");
  plan.error_blocks.push_back(std::move(block));
}

inline void add_ground(InitPlan& plan, const InitAnswers& answers) {
  plan.error_blocks.push_back(
      {"The floor: a x + b y + c z + d = 0 in link " + name_to_yaml(answers.base) +
           "; give d if its origin is not on the floor (0.1 m above it: d: 0.1).  'alone' takes "
           "the samples in which nothing but the camera observes.",
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

/// Keeps a frame near its drawing where samples say nothing of it.
inline void keep_near_drawing(InitPlan& plan, const std::string& frame, const std::string& why) {
  plan.error_blocks.push_back(
      {why + "  Such a block counts once in every sample: with 100 samples these scales say what "
             "one measurement to 0.1 m and 6 degrees says.",
       "restrict_" + frame,
       {{"type", "outrageous"},
        {"param", name_to_yaml(frame)},
        {"joint_scale", "0.0"},
        {"position_scale", "1.0"},
        {"rotation_scale", "1.0"}}});
}

/// The joint whose frame is the camera's mount.
/// @throws InputError  if there is none
[[nodiscard]] inline const Joint& require_mount(const Robot& robot, const InitAnswers& answers,
                                                const std::vector<std::string>& others) {
  const Joint* mount = camera_mount(robot, answers.camera, others);
  if (mount == nullptr) {
    throw InputError(
        fmt::format("--camera: link '{}' has no joint of its own that could be "
                    "corrected; choose another link, or another --base or --arm",
                    answers.camera));
  }
  return *mount;
}

/// The frame of a board that the gripper holds or that stands somewhere.
inline void add_board(InitPlan& plan, const std::string& name, const std::string& link) {
  free_frame(plan, name,
             "Where the checkerboard is, seen from link " + name_to_yaml(link) +
                 ".  The frame is in no URDF: it is the frame_id of the board's corners.");
  add_initial_value(plan, name,
                    "Measure by hand where the board's first corner is in link " +
                        name_to_yaml(link) +
                        " and how the board is turned (x along its rows, y along its columns).  "
                        "0.1 m and 30 degrees off are near enough; a board that is upside down "
                        "may not be found.");
}

}  // namespace kinecal::detail
