// Definitions of chain.hpp: the path from one link to another.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/chain_fold.hpp"
#include "kinecal/kinematics/floating_joint.hpp"
#include "kinecal/text/frame_name.hpp"

namespace kinecal {

namespace detail {

/// The name of a link as the robot has it, with or without a leading slash.
/// @throws RobotError  if the robot has no such link
[[nodiscard]] inline std::string link_called(const Robot& robot, const std::string& name) {
  if (const Joint* joint = robot.parent_joint(name)) return joint->child;
  for (const Joint& joint : robot.joints()) {
    if (same_frame(joint.parent, name)) return joint.parent;  // the root
  }
  return name;
}

/// Adds a floating joint to a chain: its coordinates, and a fixed joint with its correction.
inline void add_floating(const Joint& joint, const Pose<double>& fixed, bool corrected,
                         bool reversed, RuntimeChain& chain) {
  std::vector<ChainJoint> parts;
  for (std::size_t i = 0; i < kFloatingCoordinates.size(); ++i) {
    const std::string name = floating_coordinate(joint.name, i);
    const auto axis = static_cast<Eigen::Index>(i < 3 ? i : 5 - i);  // x y z, then z y x
    parts.push_back({name, i < 3 ? JointType::prismatic : JointType::continuous, Pose<double>{},
                     Vector3<double>::Unit(axis), false, reversed, Mimic{name, 1.0, 0.0}});
    parts.back().floating = joint.name;
  }
  if (corrected) {
    parts.push_back({joint.name, JointType::fixed, Pose<double>{}, joint.axis, true, reversed,
                     Mimic{joint.name, 1.0, 0.0}});
  }
  if (reversed) std::reverse(parts.begin(), parts.end());
  parts.front().fixed = fixed;
  chain.joints.insert(chain.joints.end(), parts.begin(), parts.end());
}

}  // namespace detail

KINECAL_INLINE std::vector<const Joint*> joints_to_root(const Robot& robot,
                                                        const std::string& link) {
  std::vector<const Joint*> way;
  for (const Joint* joint = robot.parent_joint(link); joint != nullptr;
       joint = robot.parent_joint(joint->parent)) {
    way.push_back(joint);
    if (way.size() > robot.joints().size()) {
      throw RobotError("link '" + link + "' is below itself");
    }
  }
  return way;
}

KINECAL_INLINE RuntimeChain make_chain(const Robot& robot, const std::string& base,
                                       const std::string& tip,
                                       const std::set<std::string>& corrected) {
  const std::string from = detail::link_called(robot, base), to = detail::link_called(robot, tip);
  const std::vector<Joint>& joints = robot.joints();
  const auto way = detail::find_way(joints, from, to, std::vector<std::size_t>(2 * joints.size()));
  if (!way.ends) throw RobotError("link '" + base + "' or '" + tip + "' is below itself");
  if (!way.is_connected) {
    throw RobotError("links '" + base + "' and '" + tip + "' are not connected in robot '" +
                     robot.name() + "'");
  }
  for (std::size_t n = 0; n < way.size; ++n) {
    const Joint& joint = joints[way.joints[n]];
    if (joint.type == JointType::floating || detail::is_passable(joint.type)) continue;
    throw RobotError("joint '" + joint.name + "' between '" + base + "' and '" + tip + "' is " +
                     std::string(to_string(joint.type)) +
                     "; chains take fixed, revolute, continuous, prismatic and floating joints");
  }
  RuntimeChain chain{from, to, {}, {}};
  chain.tail = detail::fold(
      joints, way, [&](const std::string& name) { return corrected.contains(name); },
      [&](const Joint& joint, const Pose<double>& fixed, bool is_corrected, bool reversed) {
        if (joint.type == JointType::floating) {
          detail::add_floating(joint, fixed, is_corrected, reversed, chain);
          return;
        }
        chain.joints.push_back({joint.name, joint.type, fixed, joint.axis, is_corrected, reversed,
                                drive(robot, joint)});
      });
  return chain;
}

KINECAL_INLINE RuntimeChain with_virtual_frame(RuntimeChain chain, const std::string& frame) {
  chain.joints.push_back({frame, JointType::fixed, chain.tail, Vector3<double>(1.0, 0.0, 0.0), true,
                          false, Mimic{frame, 1.0, 0.0}});
  chain.tail = {};
  chain.tip = frame;
  return chain;
}

}  // namespace kinecal
