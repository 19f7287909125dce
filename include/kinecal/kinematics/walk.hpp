// The walk: a forward pass over the joints of a chain.  All forward kinematics uses it.
//
// The walk visits the joints from base to tip and calls a visitor, the walker, for each
// constant transform, frame correction and joint motion.  A PoseWalker composes base_T_tip; a
// TwistWalker also computes how each parameter moves the tip.
//
// A joint passed from child to parent is undone: its motion first, then its correction.
// Source: ARCHITECTURE.md, idea 1: one walk.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <utility>

#include "kinecal/kinematics/corrections.hpp"
#include "kinecal/kinematics/static_chain.hpp"

namespace kinecal {

/// The visitor of a walk.  `i` is the joint's index in the chain.
template <class W, class S>
concept Walker = requires(W& w, std::size_t i, const ChainJoint& joint, const JointState<S>& motion,
                          const JointCorrection<S>& correction) {
  w.fixed(joint.fixed);
  w.correct(i, joint, correction);
  w.move(i, joint, motion);
};

namespace detail {

/// Calls visit(index, joint) for the joints from `first` on, until a call returns false.
template <class F>
void for_joints(const RuntimeChain& chain, std::size_t first, F&& visit) {
  for (std::size_t i = first; i < chain.joints.size(); ++i) {
    if (!visit(i, chain.joints[i])) return;
  }
}
/// The same with indices and joints that the compiler knows.
/// @param first  0 or kFirstMotion
template <StaticChain C, class F>
void for_joints(const C&, std::size_t first, F&& visit) {
  const auto from = [&]<std::size_t First>(std::integral_constant<std::size_t, First>) {
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (void)(visit(std::integral_constant<std::size_t, First + I>{}, StaticJoint<C, First + I>{}) &&
             ...);
    }
    (std::make_index_sequence<C::kSize - First>{});
  };
  if (first == 0) {
    from(std::integral_constant<std::size_t, 0>{});
  } else {
    from(std::integral_constant<std::size_t, C::kFirstMotion>{});
  }
}

[[nodiscard]] inline const ConstantPose& tail_of(const RuntimeChain& chain) {
  return chain.tail;
}
template <StaticChain C>
[[nodiscard]] FixedOf<C, C::kSize> tail_of(const C&) {
  return {};
}

/// The state of a joint that has models.  Not inline: few joints have them.
/// @param effects  of the parameters of its models
template <class S, class E, class U>
[[nodiscard, gnu::noinline]] auto modelled(const JointState<S>& measured, const E* effects,
                                           const JointCorrection<U>& correction) {
  using R = Product<S, U>;
  R change(0.0);
  for (std::size_t k = 0; k < correction.model.size(); ++k) {
    change += R(correction.model[k] * effects[k]);
  }
  return measured + correction.offset + make_joint_state(change);
}

}  // namespace detail

/// The part of a walk before the first moving joint: the same for all joint positions.
/// @returns  index of that joint, for walk_on(); the number of joints if all are fixed
template <class Chain, class Corrected, class W>
[[nodiscard]] std::size_t walk_to_first_motion(const Chain& chain, const Corrected& corrections,
                                               W& walker) {
  std::size_t passed = 0;
  detail::for_joints(chain, 0, [&](auto i, const auto& joint) {
    walker.fixed(joint.fixed);
    if (joint.corrected && !joint.reversed) walker.correct(i, joint, corrections[i]);
    if (moves(joint.type)) return false;
    if (joint.corrected && joint.reversed) walker.correct(i, joint, corrections[i]);
    ++passed;
    return true;
  });
  return passed;
}

/// The rest of the walk.
/// @tparam kModels  false if no joint of the chain has parameters of joint models
/// @param first     the result of walk_to_first_motion()
/// The other parameters are those of walk().
template <bool kModels = true, class Chain, class Motions, class Corrected, class W>
void walk_on(const Chain& chain, std::size_t first, const Motions& motions,
             const Corrected& corrections, W& walker) {
  detail::for_joints(chain, first, [&](auto i, const auto& joint) {
    if (i != first) {
      walker.fixed(joint.fixed);
      if (joint.corrected && !joint.reversed) walker.correct(i, joint, corrections[i]);
    }
    if (moves(joint.type)) {
      auto state = motions[i] + corrections[i].offset;
      if constexpr (kModels && requires { motions.effects(i); }) {
        if (!corrections[i].model.empty()) {
          state = detail::modelled(motions[i], motions.effects(i), corrections[i]);
        }
        walker.move(i, joint, state);
        if constexpr (requires { walker.move_by_model(i, joint, motions.effects(i)); }) {
          walker.move_by_model(i, joint, motions.effects(i));
        }
      } else {
        walker.move(i, joint, state);
      }
    }
    if (joint.corrected && joint.reversed) walker.correct(i, joint, corrections[i]);
    return true;
  });
  walker.fixed(detail::tail_of(chain));
}

/// Walks a chain from base to tip.
/// @param chain        a RuntimeChain or a Chain
/// @param motions      JointState of each joint of the chain (any scalar), by index; only if it
///                     has effects (see ModelledMotions), joint models count
/// @param corrections  JointCorrection of each joint of the chain (any scalar), by index
template <class Chain, class Motions, class Corrected, class W>
void walk(const Chain& chain, const Motions& motions, const Corrected& corrections, W& walker) {
  walk_on(chain, walk_to_first_motion(chain, corrections, walker), motions, corrections, walker);
}

}  // namespace kinecal
