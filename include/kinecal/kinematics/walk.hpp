// The walk: forward kinematics, written once.
//
// It visits the joints of a chain from base to tip and tells a walker what it meets: a constant
// transform, a corrected origin, a moving joint.  What comes of it is the walker's business: a
// PoseWalker composes base_T_tip, a TwistWalker also notes how each parameter moves the tip.
//
// A joint passed from child to parent is undone: its motion first, then its correction.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <span>

#include "kinecal/kinematics/corrections.hpp"

namespace kinecal {

/// What a walk reports to.  `i` is the joint's index in the chain.
template <class W, class S>
concept Walker = requires(W& w, std::size_t i, const ChainJoint& joint, const Motion<S>& motion,
                          const JointCorrection<S>& correction) {
  w.fixed(joint.fixed);
  w.correct(i, joint, correction);
  w.move(i, joint, motion);
};

/// The part of a walk before anything moves: the same for all positions of the joints.
/// @returns  the joint at whose motion walk_on() goes on; the number of joints if none moves
template <std::size_t N, class S, class W>
[[nodiscard]] std::size_t walk_to_first_motion(const Chain<N>& chain,
                                               std::span<const JointCorrection<S>> corrections,
                                               W& walker) {
  std::size_t i = 0;
  for (; i < chain.joints.size(); ++i) {
    const ChainJoint& joint = chain.joints[i];
    walker.fixed(joint.fixed);
    if (joint.corrected && !joint.reversed) walker.correct(i, joint, corrections[i]);
    if (moves(joint.type)) break;
    if (joint.corrected && joint.reversed) walker.correct(i, joint, corrections[i]);
  }
  return i;
}

/// The rest of it.
/// @param first  what walk_to_first_motion() returned
template <std::size_t N, class Q, class S, class W>
void walk_on(const Chain<N>& chain, std::size_t first, std::span<const Motion<Q>> motions,
             std::span<const JointCorrection<S>> corrections, W& walker) {
  for (std::size_t i = first; i < chain.joints.size(); ++i) {
    const ChainJoint& joint = chain.joints[i];
    if (i != first) {
      walker.fixed(joint.fixed);
      if (joint.corrected && !joint.reversed) walker.correct(i, joint, corrections[i]);
    }
    if (moves(joint.type)) walker.move(i, joint, motions[i] + corrections[i].offset);
    if (joint.corrected && joint.reversed) walker.correct(i, joint, corrections[i]);
  }
  walker.fixed(chain.tail);
}

/// Walks a chain from base to tip.
/// @param motions      measured motion of each joint of the chain (any scalar)
/// @param corrections  correction of each joint of the chain (any scalar)
template <std::size_t N, class Q, class S, class W>
void walk(const Chain<N>& chain, std::span<const Motion<Q>> motions,
          std::span<const JointCorrection<S>> corrections, W& walker) {
  walk_on(chain, walk_to_first_motion(chain, corrections, walker), motions, corrections, walker);
}

}  // namespace kinecal
