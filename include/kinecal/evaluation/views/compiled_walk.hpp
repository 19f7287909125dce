// The walk of a chain to its tip, for a batch of samples.
//
// The compiler knows the chains of a crate and their free parameters, so a problem that a crate
// fills uses walks compiled for them.  Others walk a RuntimeChain; both give the same result.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/packet.hpp"
#include "kinecal/parameters/free_parameters.hpp"
#include "kinecal/problem/batches.hpp"

namespace kinecal::detail {

/// The state of a walk before the first moving joint: the same for all samples of an evaluation.
template <class S>
struct WalkStart {
  Pose<S> pose;                                          ///< before the first moving joint
  const RuntimeChain* chain = nullptr;                   ///< the chain
  std::size_t joint = 0;                                 ///< index of the first moving joint
  std::span<const JointCorrection<double>> corrections;  ///< of all joints
  std::span<const JointIndices> columns;                 ///< of the free parameters of all joints
  std::size_t effects = 0;      ///< most_effects(); zero without joint models
  Twist<S>* turn = nullptr;     ///< where the next rotational twist is written, if any
  Vector3<S>* shift = nullptr;  ///< where the next translational twist is written, if any
};

/// A walk from the first moving joint on as a function, which sets the tip's pose.
/// @param joints  numbers of JointStates
template <class S>
using Walk = void (*)(const WalkStart<S>&, const S* joints, Pose<S>& tip);

/// Walks a chain from the first moving joint on.
/// @tparam kTwists  compute the twists of the free parameters, too
/// @tparam kModels  some joint has parameters of joint models
/// @param columns  of the free parameters of each joint
/// @param first    index of the first moving joint
template <bool kTwists, bool kModels, class Chain, class Columns, class S>
void walk_to_tip(const Chain& chain, const Columns& columns, std::size_t first,
                 const WalkStart<S>& start, const S* joints, Pose<S>& tip) {
  const JointStates<S, kModels> states{joints, start.effects};
  if constexpr (kTwists) {
    TwistWalker<S, Columns> walker(columns, start.turn, start.shift, start.pose);
    walk_on<kModels>(chain, first, states, start.corrections, walker);
    copy_numbers(walker.walker.pose, tip);
  } else {
    PoseWalker<S> walker;
    copy_numbers(start.pose, walker.pose);
    walk_on<kModels>(chain, first, states, start.corrections, walker);
    copy_numbers(walker.pose, tip);
  }
}

template <class S, bool kTwists, bool kModels>
KINECAL_FLATTEN void walk_runtime_chain(const WalkStart<S>& start, const S* joints, Pose<S>& tip) {
  walk_to_tip<kTwists, kModels>(*start.chain, start.columns, start.joint, start, joints, tip);
}

/// The walk of a chain that is known at run time.
template <class S>
[[nodiscard]] Walk<S> runtime_walk(bool twists, bool models) {
  constexpr Walk<S> kWalks[2][2] = {
      {&walk_runtime_chain<S, false, false>, &walk_runtime_chain<S, false, true>},
      {&walk_runtime_chain<S, true, false>, &walk_runtime_chain<S, true, true>}};
  return kWalks[twists ? 1 : 0][models ? 1 : 0];
}

/// The walks of a chain that the compiler knows, without joint models.
template <class S>
struct CompiledWalk {
  std::string tip;                      ///< of the chain
  std::vector<OffsetAndFrame> columns;  ///< for which with_twists was compiled
  Walk<S> pose_only;                    ///< computes the pose
  Walk<S> with_twists;                  ///< computes the pose and the twists of free parameters
};

/// The columns of each joint as constants.
template <class C, class F>
struct StaticColumns {
  [[nodiscard]] constexpr const OffsetAndFrame& operator[](std::size_t joint) const {
    return kColumnsOf<C, F>[joint];
  }
};

template <class S, bool kTwists, class C, class F>
KINECAL_FLATTEN void walk_static_chain(const WalkStart<S>& start, const S* joints, Pose<S>& tip) {
  walk_to_tip<kTwists, false>(C{}, StaticColumns<C, F>{}, C::kFirstMotion, start, joints, tip);
}

/// Compiles the walks of a chain.
/// @tparam C  a Chain
/// @tparam F  a FreeParameters
template <class S, StaticChain C, class F>
[[nodiscard]] CompiledWalk<S> compiled_walk() {
  const auto& columns = kColumnsOf<C, F>;
  return {.tip = std::string(C::kVirtual.empty() ? C::kTip : C::kVirtual),
          .columns = {columns.begin(), columns.end()},
          .pose_only = &walk_static_chain<S, false, C, F>,
          .with_twists = &walk_static_chain<S, true, C, F>};
}

}  // namespace kinecal::detail
