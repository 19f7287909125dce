// A kinematic chain: the joints met on the way from one link of a robot to another.
//
// Base and tip are any two links: the way leads up from the base to the lowest common ancestor and
// down to the tip.  A joint that is passed from child to parent is `reversed`:
//
//   base_T_tip = prod over joints of  fixed * (correction * motion)   passed parent to child
//                                     fixed * (motion^-1 * correction^-1)   passed child to parent
//                * tail
//
// `fixed` gathers everything constant before the joint: its own origin and the fixed joints that
// nobody corrects, so the walk meets only joints that move or are corrected.
//
// This chain is put together at run time; one that the compiler knows is in static_chain.hpp.  The
// walk is the same for both.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// A constant pose that knows whether it turns: most origins only shift, a quarter of the work.
struct ConstantPose : Pose<double> {
  bool turns = false;

  ConstantPose() = default;
  ConstantPose(const Pose<double>& pose)  // NOLINT: any pose may be constant
      : Pose(pose) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) turns = turns || pose.rotation(i, j) != (i == j ? 1.0 : 0.0);
    }
  }
};

/// The axis of a frame with which a unit vector is parallel: 0, 1, 2 for x, y, z; -1 for none.
[[nodiscard]] inline int principal_axis(const Vector3<double>& axis) {
  for (int i = 0; i < 3; ++i) {
    const bool others_are_zero = axis((i + 1) % 3) == 0.0 && axis((i + 2) % 3) == 0.0;
    if (others_are_zero && std::abs(axis(i)) == 1.0) return i;
  }
  return -1;
}

/// One joint on the way, as the walk needs it.
struct ChainJoint {
  std::string name;
  JointType type = JointType::fixed;
  ConstantPose fixed;  ///< constant transform from the previous joint (or the base) to this one
  Vector3<double> axis{1.0, 0.0, 0.0};
  bool corrected = false;  ///< has a frame correction
  bool reversed = false;   ///< passed from child to parent
  Mimic drive;             ///< whose measured position moves it; itself, unless it mimics
  int principal = principal_axis(axis);  ///< most axes are: about them only two columns turn
};

struct RuntimeChain {
  std::string base, tip;
  std::vector<ChainJoint> joints;
  ConstantPose tail;  ///< constant transform from the last joint to the tip
};

/// Joints from `link` up to the root, the link's own parent joint first.
[[nodiscard]] inline std::vector<const Joint*> joints_to_root(const Robot& robot,
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

/// The chain from `base` to `tip`.
/// @param corrected  names of the joints with a frame correction; they are kept even when fixed
/// @throws RobotError  if a link does not exist (with the nearest name), the two are not connected,
///                     or a joint between them is floating or planar
[[nodiscard]] inline RuntimeChain make_chain(const Robot& robot, const std::string& base,
                                        const std::string& tip,
                                        const std::set<std::string>& corrected = {}) {
  std::vector<const Joint*> up = joints_to_root(robot, base);
  std::vector<const Joint*> down = joints_to_root(robot, tip);
  const auto root = [](const std::vector<const Joint*>& way, const std::string& link) {
    return way.empty() ? link : way.back()->parent;
  };
  if (root(up, base) != root(down, tip)) {
    throw RobotError("links '" + base + "' and '" + tip + "' are not connected in robot '" +
                     robot.name() + "'");
  }
  while (!up.empty() && !down.empty() && up.back() == down.back()) {  // above the ancestor
    up.pop_back();
    down.pop_back();
  }
  std::reverse(down.begin(), down.end());

  RuntimeChain chain{base, tip, {}, {}};
  Pose<double> fixed;
  const auto pass = [&](const Joint& joint, bool reversed) {
    if (joint.type == JointType::floating || joint.type == JointType::planar) {
      throw RobotError("joint '" + joint.name + "' between '" + base + "' and '" + tip + "' is " +
                       std::string(to_string(joint.type)) +
                       "; chains take fixed, revolute, continuous and prismatic joints");
    }
    if (!reversed) fixed = fixed * joint.origin;
    const bool is_corrected = corrected.contains(joint.name);
    if (is_corrected || moves(joint.type)) {
      chain.joints.push_back(
          {joint.name, joint.type, fixed, joint.axis, is_corrected, reversed, drive(robot, joint)});
      fixed = {};
    }
    if (reversed) fixed = fixed * joint.origin.inverse();
  };
  for (const Joint* joint : up) pass(*joint, true);
  for (const Joint* joint : down) pass(*joint, false);
  chain.tail = fixed;
  return chain;
}

/// The same chain with a virtual frame beyond its tip: a corrected, fixed joint of that name with
/// an origin of identity.  Such frames (a checkerboard, a marker, a tracker) are in no URDF.
[[nodiscard]] inline RuntimeChain with_virtual_frame(RuntimeChain chain, const std::string& frame) {
  chain.joints.push_back({frame, JointType::fixed, chain.tail, Vector3<double>(1.0, 0.0, 0.0), true,
                          false, Mimic{frame, 1.0, 0.0}});
  chain.tail = {};
  chain.tip = frame;
  return chain;
}

}  // namespace kinecal
