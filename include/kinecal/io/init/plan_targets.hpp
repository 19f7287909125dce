// What each target tells of a robot, and what it leaves open: which offsets and frames are freed.
//
// A frame that is free at an end of a chain stands for the joint next to it: the turn of a tracker
// is the offset of the first joint, the place of a reflector that of the last.  Freed together,
// only their sum would be seen; so one of them is left out, and the configuration says why.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/io/init/plan_entries.hpp"

namespace kinecal::detail {

/// LEDs on the gripper or a board in it, seen by a camera that does not move with it.
[[nodiscard]] inline InitPlan plan_hand_eye(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  std::vector<ChainJoint> arm = movers(robot, answers.base, answers.arm);
  std::vector<ChainJoint> head = movers(robot, answers.base, answers.camera);
  for (const std::string& joint : leave_out_common(arm, head)) {
    plan.left_out.push_back({joint, "It moves arm and camera alike"});
  }
  if (arm.empty()) {
    throw InputError(fmt::format(
        "--camera: camera '{}' moves with arm '{}' and sees the same in every pose; let it see a "
        "board in the world: --target world_checkerboard",
        answers.camera, answers.arm));
  }
  const bool board = answers.target == InitTarget::checkerboard;
  add_chain_model(plan,
                  board ? "Knows where the corners are on the board, and the board in its link."
                        : "Knows where the LEDs are in its link.",
                  "arm", answers.arm);
  add_camera_model(plan, answers);

  const std::string mount = require_mount(robot, answers, {answers.base, answers.arm}).name;
  const std::string head_frame = head.empty() ? mount : head.front().name;
  if (board) add_board(plan, answers.target_frame, answers.arm);
  free_offsets(plan, arm, head_frame, board ? answers.target_frame : "");
  const bool mount_moves =
      std::any_of(head.begin(), head.end(), [&](const ChainJoint& j) { return j.name == mount; });
  free_offsets(plan, head, head_frame, mount_moves ? mount : "");
  if (!head.empty()) {
    free_frame(plan, head_frame, "How that which carries the camera stands on the robot.");
  }
  free_frame(plan, mount, "How the camera is mounted.");
  free_camera(plan, answers, false);
  add_hand_eye(plan, answers, "arm");
  if (!head.empty()) {
    keep_near_drawing(plan, mount,
                      "A turn of the joint that carries the camera is one of the camera's frame "
                      "the other way: the drawing of the camera decides.");
  }
  return plan;
}

/// Two joints that turn at least: fewer do not tell where on what they move something is.
[[nodiscard]] inline bool turns_about_two_axes(const std::vector<ChainJoint>& way) {
  return std::count_if(way.begin(), way.end(),
                       [](const ChainJoint& joint) { return turns(joint.type); }) >= 2;
}

/// A board in the world, seen by a camera that the robot moves.
[[nodiscard]] inline InitPlan plan_world_checkerboard(const Robot& robot,
                                                      const InitAnswers& answers) {
  InitPlan plan;
  const std::vector<ChainJoint> way = movers(robot, answers.base, answers.camera);
  if (way.empty()) {
    throw InputError(
        fmt::format("--camera: camera '{}' does not move in link '{}'; a board that "
                    "stands in the world then tells nothing",
                    answers.camera, answers.base));
  }
  add_chain_model(plan, "Knows where the corners are on the board, which stands in this link.",
                  "board", answers.base);
  add_camera_model(plan, answers);
  const std::string mount = require_mount(robot, answers, {answers.base}).name;
  add_board(plan, answers.target_frame, answers.base);
  free_offsets(plan, way, answers.target_frame, mount);
  free_frame(plan, mount, "How the camera is mounted.");
  free_camera(plan, answers, false);
  add_hand_eye(plan, answers, "board");
  if (!turns_about_two_axes(way)) {
    keep_near_drawing(plan, mount,
                      "A camera that turns about one axis at most does not tell its frame from "
                      "that of the board: its drawing decides.");
  }
  return plan;
}

/// A reflector on the arm and a tracker that stands in the world.
[[nodiscard]] inline InitPlan plan_tracker(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  const std::vector<ChainJoint> way = movers(robot, answers.base, answers.arm);
  if (way.empty()) {
    throw InputError(
        fmt::format("--arm: link '{}' does not move in link '{}'", answers.arm, answers.base));
  }
  const std::string &tracker = answers.tracker_frame, &reflector = answers.target_frame;
  add_chain_model(plan, "Knows where the reflector is: point (0, 0, 0) of frame " + reflector + ".",
                  "arm", answers.arm);
  add_chain_model(plan,
                  "What was measured, in frame " + tracker + "; the tracker itself stands still.",
                  "tracker", answers.base);
  free_offsets(plan, way, tracker, reflector);
  free_frame(plan, tracker,
             "Where the tracker stands, seen from link " + name_to_yaml(answers.base) +
                 ".  The frame is in no URDF: it is the frame_id of the measured points.");
  free_frame(plan, reflector,
             "Where the reflector (SMR) is in link " + name_to_yaml(answers.arm) +
                 "; a point has no rotation.  In no URDF either.",
             true);
  add_initial_value(plan, tracker,
                    "Measure by hand where the tracker stands and how it is turned: 0.5 m and 60 "
                    "degrees off are near enough.");
  add_initial_value(plan, reflector, "");
  plan.error_blocks.push_back(
      {"Both tell of the same point.  sigma is how well the tracker measures and the robot "
       "repeats, in metres.",
       "measured",
       {{"type", "chain3d_to_chain3d"},
        {"model_a", "arm"},
        {"model_b", "tracker"},
        {"sigma", "0.0001"},
        {"loss", "{type: huber, scale: 3.0}"}}});
  if (!turns_about_two_axes(way)) {
    keep_near_drawing(plan, reflector,
                      "An arm that turns about one axis at most does not tell where the reflector "
                      "is from where the tracker stands.");
  }
  return plan;
}

/// The floor alone.
[[nodiscard]] inline InitPlan plan_ground(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  add_camera_model(plan, answers);
  const std::string mount = require_mount(robot, answers, {answers.base}).name;
  for (const ChainJoint& joint : movers(robot, answers.base, answers.camera)) {
    plan.left_out.push_back({joint.name,
                             "The floor tells the camera's height and tilt, not which "
                             "joint or frame is wrong; the camera's frame stands for "
                             "all"});
  }
  free_frame(plan, mount, "How the camera is mounted.");
  free_camera(plan, answers, true);
  keep_near_drawing(plan, mount,
                    "A floor tells nothing of shifts along it or turns about its normal: the "
                    "drawing decides.");
  return plan;
}

}  // namespace kinecal::detail
