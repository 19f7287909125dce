// The content of a first configuration: the entries of its lists, each with its reason.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/kinematics/chain.hpp"

namespace kinecal::detail {

/// One entry of a list: a comment, a name, and keys with YAML values.  Without keys, only the name.
struct InitEntry {
  std::string why;
  std::string name;  ///< not yet quoted for YAML
  std::vector<std::pair<std::string, std::string>> fields;
};

/// An offset that is not freed, with the reason.
struct InitLeftOut {
  std::string joint, why;
};

struct InitPlan {
  std::vector<InitEntry> models, free_params, free_frames, initial_values, error_blocks;
  std::vector<InitLeftOut> left_out;
};

/// The initial value of a frame that is not in the URDF: zeros, to be replaced by hand.
inline void add_initial_value(InitPlan& plan, const std::string& frame, const std::string& why) {
  plan.initial_values.push_back({why, frame, {}});
  for (const char* key : {"x", "y", "z", "roll", "pitch", "yaw"}) {
    plan.initial_values.back().fields.emplace_back(key, "0.0");
  }
}

/// Frees a frame once: its position and, unless it is the frame of a point, its rotation.
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
/// @throws RobotError  like make_chain()
[[nodiscard]] inline std::vector<ChainJoint> movers(const Robot& robot, const std::string& base,
                                                    const std::string& tip) {
  return make_chain(robot, base, tip).joints;
}

/// Removes the common joints at the beginning of two chains.
/// @return  names of the removed joints
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

/// Number of joints up to and including the first one that rotates: a free frame before them can
/// replace their offsets.  Sliding joints count even if they are not parallel, because only samples
/// that move them would show the difference.
template <class Iterator>
[[nodiscard]] std::size_t up_to_first_turn(Iterator begin, Iterator end) {
  const auto first = std::find_if(begin, end, [](const ChainJoint& j) { return turns(j.type); });
  return static_cast<std::size_t>(first - begin) + (first == end ? 0 : 1);
}

/// Frees a joint's offset; skips a mimic joint.
inline void free_offset(InitPlan& plan, const ChainJoint& joint) {
  if (joint.drive.joint != joint.name) {
    plan.left_out.push_back({joint.name, "It mimics joint " + name_to_yaml(joint.drive.joint) +
                                             ", which has the offset"});
    return;
  }
  plan.free_params.push_back({"", joint.name, {}});
}

/// Frees the offsets of a chain's joints, except those at its ends that a free frame there can
/// replace.
/// @param before, after  free frames at the beginning and the end of the chain; empty: not free
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
      plan.left_out.push_back({name, "Its frame is free, which includes its offset"});
    } else {
      plan.left_out.push_back({name, "Frame " + name_to_yaml(frame) +
                                         " is free, and no sample can distinguish its rotation (or "
                                         "shift) from this joint's offset"});
    }
  }
}

}  // namespace kinecal::detail
