// The links and joints of a camera, and the joint whose frame describes its mount.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/kinematics/chain.hpp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal::detail {

[[nodiscard]] inline bool contains_word(const std::string& name, std::string_view word) {
  const auto lower = [](char c) { return 'A' <= c && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  const auto same = [&](char a, char b) { return lower(a) == b; };
  return std::search(name.begin(), name.end(), word.begin(), word.end(), same) != name.end();
}

[[nodiscard]] inline bool looks_like_camera(const std::string& link) {
  for (const char* word : {"optical", "camera", "kinect", "xtion", "realsense"}) {
    if (contains_word(link, word)) return true;
  }
  return false;
}

/// True if a link and everything it carries look like parts of a camera and do not move.
[[nodiscard]] inline bool is_camera_only(const Robot& robot, const std::string& link) {
  if (!looks_like_camera(link)) return false;
  return std::all_of(robot.joints().begin(), robot.joints().end(), [&](const Joint& joint) {
    if (!same_frame(joint.parent, link)) return true;
    return joint.type == JointType::fixed && is_camera_only(robot, joint.child);
  });
}

/// The joints of a camera: its own, and fixed ones above it up to the one that attaches it to the
/// robot.  A joint above its own may carry only the camera: a flange is not part of it.
/// @param others  links whose joints do not belong to the camera
[[nodiscard]] inline std::vector<const Joint*> camera_joints(
    const Robot& robot, const std::string& camera, const std::vector<std::string>& others) {
  std::set<const Joint*> shared;
  for (const std::string& link : others) {
    for (const Joint* joint : joints_to_root(robot, link)) shared.insert(joint);
  }
  std::vector<const Joint*> own;
  for (const Joint* joint : joints_to_root(robot, camera)) {
    if (shared.contains(joint)) break;
    const bool is_above = !own.empty();
    if (is_above && own.back()->type != JointType::fixed) break;
    if (is_above && (joint->type != JointType::fixed || !is_camera_only(robot, joint->child)))
      break;
    own.push_back(joint);
  }
  return own;
}

/// The joint whose frame describes a camera's mount.  Usually the joint that attaches it to the
/// robot, if that has no origin, as if left to the calibration; else the nearest one that does more
/// than rotate the axes into an optical frame.  Null if no joint belongs to the camera alone.
[[nodiscard]] inline const Joint* camera_mount(const Robot& robot, const std::string& camera,
                                               const std::vector<std::string>& others) {
  const std::vector<const Joint*> own = camera_joints(robot, camera, others);
  if (own.empty()) return nullptr;
  const auto is_moved = [](const Joint& joint) { return joint.origin.translation.norm() > 0.0; };
  const Joint& last = *own.back();
  const bool has_origin = is_moved(last) || !last.origin.rotation.isIdentity();
  if (!has_origin) return &last;
  for (const Joint* joint : own) {
    if (joint->type != JointType::fixed || is_moved(*joint)) return joint;
  }
  return &last;
}

}  // namespace kinecal::detail
