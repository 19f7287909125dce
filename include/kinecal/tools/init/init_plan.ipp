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
#include "kinecal/tools/init/determined_offsets.hpp"

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
inline void remove_common(std::vector<ChainJoint>& a, std::vector<ChainJoint>& b) {
  while (!a.empty() && !b.empty() && a.front().name == b.front().name) {
    a.erase(a.begin());
    b.erase(b.begin());
  }
}

/// Frees the offsets of joints that samples determine, and gives the reason for the others.
/// @returns  whether samples also determine the frames
inline bool free_offsets(InitPlan& plan, const Robot& robot, const MeasuredTarget& measured,
                         const std::vector<std::string>& frames) {
  const OffsetEffects effects =
      offset_effects(robot, measured, frames, driven_joints(robot, measured));
  for (const OffsetEffect& effect : effects.offsets) {
    if (effect.determined) {
      plan.free_params.push_back({"", effect.joint, {}});
    } else if (!effect.is_seen) {
      plan.left_out.push_back({effect.joint, "It moves the arm and the camera alike"});
    } else if (effect.imitated_by == effect.joint) {
      plan.left_out.push_back({effect.joint, "Its frame is free, which includes its offset"});
    } else if (!effect.imitated_by.empty()) {
      plan.left_out.push_back(
          {effect.joint, "Frame " + name_to_yaml(effect.imitated_by) +
                             " is free, and no sample can distinguish its rotation (or "
                             "shift) from this joint's offset"});
    } else {
      plan.left_out.push_back({effect.joint,
                               "No sample can distinguish its offset from changes of the free "
                               "frames and of the offsets above"});
    }
  }
  for (const std::string& end : {measured.target, measured.sensor}) {
    for (const ChainJoint& joint : movers(robot, measured.base, end)) {
      const auto is_known = [&](const InitLeftOut& known) { return known.joint == joint.name; };
      if (joint.drive.joint == joint.name ||
          std::any_of(plan.left_out.begin(), plan.left_out.end(), is_known)) {
        continue;
      }
      plan.left_out.push_back({joint.name, "It mimics joint " + name_to_yaml(joint.drive.joint) +
                                               ", which has the offset"});
    }
  }
  return effects.frames_determined;
}

}  // namespace kinecal::detail
