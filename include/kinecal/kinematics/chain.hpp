// A kinematic chain: the joints between two links of a robot.
//
// Base and tip are any two links: the chain goes up from the base to the lowest common ancestor and
// down to the tip.  A joint that it passes from child to parent is `reversed`:
//
//   base_T_tip = prod over joints of  fixed * (correction * motion)   passed parent to child
//                                     fixed * (motion^-1 * correction^-1)   passed child to parent
//                * tail
//
// `fixed` holds everything constant before the joint: its own origin and the uncorrected fixed
// joints before it.  So the walk visits only joints that move or are corrected.
//
// This chain is built at run time; static_chain.hpp has the compile-time one.  Both use the same
// code to fold (chain_fold.hpp) and to walk (walk.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// A constant pose that knows whether it rotates.  Most origins of a URDF only translate, which
/// costs a quarter as much.
struct ConstantPose : Pose<double> {
  bool rotates = false;  ///< false if the rotation is the identity

  ConstantPose() = default;
  /// Compares the rotation with the identity, exactly.
  ConstantPose(const Pose<double>& pose)  // NOLINT: any pose may be constant
      : Pose(pose) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) rotates = rotates || pose.rotation(i, j) != (i == j ? 1.0 : 0.0);
    }
  }
};

/// The axis of its frame that a unit vector is parallel to: 0, 1, 2 for x, y, z; -1 for none.
[[nodiscard]] inline int principal_axis(const Vector3<double>& axis) {
  for (int i = 0; i < 3; ++i) {
    const bool others_are_zero = axis((i + 1) % 3) == 0.0 && axis((i + 2) % 3) == 0.0;
    if (others_are_zero && std::abs(axis(i)) == 1.0) return i;
  }
  return -1;
}

/// One joint of a chain, as the walk needs it.  A floating joint is six of them (floating_joint.hpp),
/// and a fixed one with its correction.
struct ChainJoint {
  std::string name;                   ///< of the joint, or of a virtual frame
  JointType type = JointType::fixed;  ///< fixed only if it is corrected
  ConstantPose fixed;  ///< constant transform from the previous joint (or the base) to this one
  Vector3<double> axis{1.0, 0.0, 0.0};  ///< unit vector, in the joint's frame
  bool corrected = false;               ///< has a frame correction
  bool reversed = false;                ///< passed from child to parent
  Mimic drive;  ///< the joint whose measured position moves this one: itself, unless it mimics
  int principal = principal_axis(axis);  ///< about a principal axis, only two columns rotate
  std::string floating = {};  ///< the floating joint that this is a coordinate of; empty: none
};

/// True for a joint with a position of its own: it moves, and is no coordinate of a measured pose.
[[nodiscard]] inline bool has_position(const ChainJoint& joint) {
  return moves(joint.type) && joint.floating.empty();
}

/// A chain that is built at run time: see make_chain().
struct RuntimeChain {
  std::string base;                ///< link at which it starts
  std::string tip;                 ///< link or virtual frame at which it ends
  std::vector<ChainJoint> joints;  ///< from base to tip
  ConstantPose tail;               ///< constant transform from the last joint to the tip
};

/// The joints from a link up to the root, the link's parent joint first.
/// @throws RobotError  if the link does not exist or is below itself
[[nodiscard]] std::vector<const Joint*> joints_to_root(const Robot& robot, const std::string& link);

/// The chain from `base` to `tip`, any two links of the robot.
/// @param corrected  names of the joints with a frame correction; fixed ones among them are kept
/// @throws RobotError  if a link does not exist (with the nearest name), if the two links are not
///                     connected, or if a joint between them is planar
[[nodiscard]] RuntimeChain make_chain(const Robot& robot, const std::string& base,
                                      const std::string& tip,
                                      const std::set<std::string>& corrected = {});

/// The same chain with a virtual frame beyond its tip: a fixed joint of that name with a correction
/// and an identity origin.  Use it for a frame that is not in the URDF: a checkerboard, a marker, a
/// tracker.
[[nodiscard]] RuntimeChain with_virtual_frame(RuntimeChain chain, const std::string& frame);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/kinematics/chain.ipp"
#endif
