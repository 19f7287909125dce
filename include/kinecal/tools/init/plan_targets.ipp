// The offsets and frames that each target determines: these are freed, the others left out.
//
// A free frame can replace a joint's offset: the rotation of a tracker that of the first joint, the
// position of a reflector that of the last.  With both free, the samples would only determine their
// sum.  So the offset is left out, and the configuration gives the reason: determined_offsets.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/tools/init/plan_entries.ipp"

namespace kinecal::detail {

/// LEDs or a board on the gripper, seen by a camera that does not move with it.
[[nodiscard]] inline InitPlan plan_hand_eye(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  std::vector<ChainJoint> arm = movers(robot, answers.base, answers.arm);
  std::vector<ChainJoint> head = movers(robot, answers.base, answers.camera);
  remove_common(arm, head);
  if (arm.empty()) {
    throw InputError(fmt::format(
        "--camera: camera '{}' moves with arm '{}' and sees the same in every pose; let it see a "
        "board in the world: --target world_checkerboard",
        answers.camera, answers.arm));
  }
  const bool board = answers.target == InitTarget::checkerboard;
  add_chain_model(plan,
                  board ? "The arm, which holds the board: the points are the board's corners."
                        : "The arm: the points are the LEDs, at known places in this link.",
                  holder_of(answers), answers.arm);
  add_camera_model(plan, answers);

  const std::string mount = require_mount(robot, answers, {answers.base, answers.arm}).name;
  const std::string head_frame = head.empty() ? mount : head.front().name;
  if (board) add_board(plan, answers.target_frame, answers.arm);
  MeasuredTarget seen = seen_by_camera(answers, answers.arm);
  if (!board) seen.target_frame.clear();
  std::vector<std::string> frames = {head_frame};
  if (mount != head_frame) frames.push_back(mount);
  const bool determined = free_offsets(plan, robot, seen, frames);
  if (!head.empty()) {
    free_frame(plan, head_frame, "How the part that carries the camera is mounted on the robot.");
  }
  free_frame(plan, mount, "How the camera is mounted.");
  free_camera(plan, answers, false);
  add_hand_eye(plan, answers);
  if (!determined) {
    keep_near_zero(plan, mount,
                   "The joints cannot show all of the camera's frame beside the others: this block "
                   "keeps its correction small.");
  }
  return plan;
}

/// A board in the world, seen by a camera that the robot moves.
[[nodiscard]] inline InitPlan plan_world_checkerboard(const Robot& robot,
                                                      const InitAnswers& answers) {
  InitPlan plan;
  const std::vector<ChainJoint> way = movers(robot, answers.base, answers.camera);
  if (way.empty()) {
    throw InputError(fmt::format(
        "--camera: camera '{}' does not move relative to link '{}', so a board that stands in the "
        "world determines nothing; choose another link, or another --base",
        answers.camera, answers.base));
  }
  add_chain_model(plan, "The board, which stands still in this link: the points are its corners.",
                  holder_of(answers), answers.base);
  add_camera_model(plan, answers);
  const std::string mount = require_mount(robot, answers, {answers.base}).name;
  add_board(plan, answers.target_frame, answers.base);
  const bool determined = free_offsets(plan, robot, seen_by_camera(answers, answers.base), {mount});
  free_frame(plan, mount, "How the camera is mounted.");
  free_camera(plan, answers, false);
  add_hand_eye(plan, answers);
  if (!determined) {
    keep_near_zero(plan, mount,
                   "The camera does not turn about two axes, so samples cannot distinguish all of "
                   "its frame from the board's: this block keeps the correction of the camera's "
                   "frame small.");
  }
  return plan;
}

/// A reflector on the arm and a tracker fixed in the world.
[[nodiscard]] inline InitPlan plan_tracker(const Robot& robot, const InitAnswers& answers) {
  InitPlan plan;
  const std::vector<ChainJoint> way = movers(robot, answers.base, answers.arm);
  if (way.empty()) {
    throw InputError(
        fmt::format("--arm: link '{}' does not move relative to link '{}'; choose another link, or "
                    "another --base",
                    answers.arm, answers.base));
  }
  const std::string &tracker = answers.tracker_frame, &reflector = answers.target_frame;
  std::vector<std::string> reflectors = answers.more_reflectors;
  reflectors.insert(reflectors.begin(), reflector);
  add_chain_model(plan,
                  reflectors.size() == 1
                      ? "The arm: the reflector is point (0, 0, 0) of frame " + reflector + "."
                      : "The arm: each reflector is point (0, 0, 0) of its frame.",
                  holder_of(answers), answers.arm);
  add_chain_model(
      plan,
      "The tracker, which stands still in this link: measured points in frame " + tracker + ".",
      tracker_of(answers), answers.base);
  MeasuredTarget followed{answers.base, answers.arm, answers.base};
  followed.target_frame = reflector;
  followed.is_point = true;
  followed.sensor_frame = tracker;
  const bool determined = free_offsets(plan, robot, followed, {});
  free_frame(
      plan, tracker,
      "Where the tracker stands, seen from link " + name_to_yaml(answers.base) +
          ".  The URDF does not contain this frame; it is the frame_id of the measured points.");
  for (const std::string& frame : reflectors) {
    free_frame(plan, frame,
               "Where the reflector (SMR) is in link " + name_to_yaml(answers.arm) +
                   "; a point has no rotation.  The URDF does not contain this frame either.",
               true);
  }
  add_initial_value(plan, tracker,
                    "Zeros are no guess: kinecal searches for the tracker.  Should it not find it, "
                    "measure where it stands and how it is turned.");
  for (const std::string& frame : reflectors) add_initial_value(plan, frame, "");
  InitEntry measured{
      "Both observe the same point.  The noise is what residuals show; 'sigma' would give it.",
      "measured",
      {{"type", "chain3d_to_chain3d"},
       {"model_a", name_to_yaml(holder_of(answers))},
       {"model_b", name_to_yaml(tracker_of(answers))}}};
  if (!determined) {  // the prior below is weighed against it
    measured.why =
        "Both observe the same point.  sigma combines the accuracy of the tracker and the "
        "repeatability of the robot, in metres: 0.0001 is a guess, write yours.";
    measured.fields.emplace_back("sigma", "0.0001");
  }
  measured.fields.emplace_back("loss", "{type: huber, scale: 3.0}");
  plan.error_blocks.push_back(std::move(measured));
  if (!determined) {
    keep_near_zero(plan, reflector,
                   "The arm does not turn about two axes, so samples cannot distinguish all of the "
                   "reflector's position from the tracker's: this block keeps the reflector near "
                   "the origin of its link.");
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
                             "The floor determines the camera's height and tilt, not which joint "
                             "or frame is wrong; the camera's frame stands for all of them"});
  }
  free_frame(plan, mount, "How the camera is mounted.");
  free_camera(plan, answers, true);
  keep_near_zero(plan, mount,
                 "The floor does not determine shifts along it and rotations about its normal: "
                 "this block keeps the correction of the camera's frame small.");
  return plan;
}

/// Plans what to free and compare.
/// @throws InputError  if a link cannot be reached, or the target determines nothing of this robot
[[nodiscard]] inline InitPlan plan_initial_config(const Robot& robot, const InitAnswers& answers) {
  try {
    InitPlan plan;
    if (answers.target == InitTarget::tracker) return plan_tracker(robot, answers);
    if (answers.target == InitTarget::ground) {
      plan = plan_ground(robot, answers);
    } else if (answers.target == InitTarget::world_checkerboard) {
      plan = plan_world_checkerboard(robot, answers);
    } else {
      plan = plan_hand_eye(robot, answers);
    }
    if (answers.target == InitTarget::ground || answers.with_ground) {
      add_ground(plan, answers);
    }
    return plan;
  } catch (const RobotError& e) {
    throw InputError(std::string("--base: ") + e.what());
  }
}

}  // namespace kinecal::detail
