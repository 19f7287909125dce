// What a first configuration consists of: entries of its lists, each with the reason for it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/io/init/robot_parts.hpp"
#include "kinecal/io/yaml/yaml_text.hpp"

namespace kinecal {

/// One entry of a list: a comment, and its keys with their values as YAML; an entry without keys is
/// a name alone.
struct InitEntry {
  std::string why;
  std::string name;  ///< not yet YAML
  std::vector<std::pair<std::string, std::string>> fields;
};

/// An offset that is not freed, and why.
struct InitLeftOut {
  std::string joint, why;
};

struct InitPlan {
  std::vector<InitEntry> models, free_params, free_frames, initial_values, error_blocks;
  std::vector<InitLeftOut> left_out;
};

namespace detail {

/// Where a frame starts that is in no URDF, and of which there is nothing but a guess.
inline void add_initial_value(InitPlan& plan, const std::string& frame, const std::string& why) {
  plan.initial_values.push_back({why, frame, {}});
  for (const char* key : {"x", "y", "z", "roll", "pitch", "yaw"}) {
    plan.initial_values.back().fields.emplace_back(key, "0.0");
  }
}

/// Frees a frame once: its place, and its rotation too unless it is that of a point.
inline void free_frame(InitPlan& plan, const std::string& name, const std::string& why,
                       bool is_point = false) {
  for (const InitEntry& frame : plan.free_frames) {
    if (frame.name == name) return;
  }
  plan.free_frames.push_back({why, name, {}});
  const std::array<const char*, 6> axes = {"x", "y", "z", "roll", "pitch", "yaw"};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    plan.free_frames.back().fields.emplace_back(axes[i], i < 3 || !is_point ? "true" : "false");
  }
}

/// The joints that move between two links.
/// @throws RobotError  as make_chain()
[[nodiscard]] inline std::vector<ChainJoint> movers(const Robot& robot, const std::string& base,
                                                    const std::string& tip) {
  return make_chain(robot, base, tip).joints;
}

/// Leaves out what two ways have in common at their beginning.
/// @return  names of the joints left out
inline std::vector<std::string> leave_out_common(std::vector<ChainJoint>& a,
                                                 std::vector<ChainJoint>& b) {
  std::vector<std::string> common;
  while (!a.empty() && !b.empty() && a.front().name == b.front().name) {
    common.push_back(a.front().name);
    a.erase(a.begin());
    b.erase(b.begin());
  }
  return common;
}

/// Number of joints from the first one to the first that turns, it included: a frame before them
/// moves all that follows just as their offsets do.  Joints that slide count even where they are
/// not parallel, as only samples that move them would tell.
template <class Iterator>
[[nodiscard]] std::size_t up_to_first_turn(Iterator begin, Iterator end) {
  const auto first = std::find_if(begin, end, [](const ChainJoint& j) { return turns(j.type); });
  return static_cast<std::size_t>(first - begin) + (first == end ? 0 : 1);
}

/// A joint's offset: free, or left out where it is none of its own.
inline void free_offset(InitPlan& plan, const ChainJoint& joint) {
  if (joint.drive.joint != joint.name) {
    plan.left_out.push_back(
        {joint.name, "It mimics joint " + name_to_yaml(joint.drive.joint) + " and has none"});
    return;
  }
  plan.free_params.push_back({"", joint.name, {}});
}

/// Frees the offsets of the joints of a way, but for those at its ends that a free frame there
/// stands for.
/// @param before, after  free frames at the beginning and the end of the way; empty: none
inline void free_offsets(InitPlan& plan, const std::vector<ChainJoint>& way,
                         const std::string& before, const std::string& after) {
  const std::size_t first = before.empty() ? 0 : up_to_first_turn(way.begin(), way.end());
  const std::size_t last =
      way.size() - (after.empty() ? 0 : up_to_first_turn(way.rbegin(), way.rend()));
  for (std::size_t i = 0; i < way.size(); ++i) {
    const std::string& name = way[i].name;
    if (i >= first && i < last) {
      free_offset(plan, way[i]);
    } else if (const std::string& frame = i < first ? before : after; name == frame) {
      plan.left_out.push_back({name, "Its frame is free, and moves all that its offset moves"});
    } else {
      plan.left_out.push_back({name, "Frame " + name_to_yaml(frame) +
                                         " is free; its turn (or shift) and this joint's offset "
                                         "look the same in every sample"});
    }
  }
}

/// The joint whose frame stands for how a camera is mounted: the nearest fixed one above it, but
/// not the one that only turns the axes to those of an optical frame; a moving one where no other
/// is.  Nothing if no joint is the camera's own.
/// @param others  links whose ways from the root do not belong to the camera
[[nodiscard]] inline const Joint* camera_mount(const Robot& robot, const std::string& camera,
                                               const std::vector<std::string>& others) {
  std::set<const Joint*> shared;
  for (const std::string& link : others) {
    for (const Joint* joint : joints_to_root(robot, link)) shared.insert(joint);
  }
  const Joint* mount = nullptr;
  for (const Joint* joint : joints_to_root(robot, camera)) {
    if (shared.contains(joint) || (mount != nullptr && joint->type != JointType::fixed)) break;
    const bool only_turns = joint->origin.translation.norm() == 0.0;
    mount = joint;
    if (joint->type != JointType::fixed || !only_turns) break;
  }
  return mount;
}

}  // namespace detail

}  // namespace kinecal
