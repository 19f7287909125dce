// The walk of one chain, compiled for that chain and its free parameters.
//
// The compiler knows the chains of a crate.  A problem that a crate fills uses these walks in place
// of those of a RuntimeChain; both give the same result.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/packet.hpp"
#include "kinecal/parameters/free_parameters.hpp"
#include "kinecal/problem/batch.hpp"

namespace kinecal::detail {

/// The state of a walk before the first moving joint: the same for all samples of an evaluation.
template <class S>
struct WalkStart {
  Pose<S> pose;                                          ///< before the first moving joint
  std::size_t joint = 0;                                 ///< index of that joint
  const JointCorrection<double>* corrections = nullptr;  ///< of all joints
  Twist<S>* turn = nullptr;     ///< where the next rotational twist is written, if any
  Vector3<S>* shift = nullptr;  ///< where the next translational twist is written, if any
};

/// The walk of one chain as functions.
template <class S>
struct CompiledWalk {
  /// Walks from the first moving joint on and sets the tip's pose.
  /// @param joints  numbers of JointStates
  using Walk = void (*)(const WalkStart<S>&, const S* joints, Pose<S>& tip);

  std::string tip;                    ///< of the chain
  std::vector<JointIndices> columns;  ///< for which with_twists is compiled
  bool models;                        ///< whether both know joint models
  Walk pose_only;                     ///< computes the pose
  Walk with_twists;                   ///< computes the pose and the twists of free parameters
};

/// The columns of each joint as constants.
template <class C, class F>
struct StaticColumns {
  [[nodiscard]] constexpr const JointIndices& operator[](std::size_t joint) const {
    return kColumnsOf<C, F>[joint];
  }
};

template <class S, class C, class F>
struct WalkOf {
  static constexpr bool kModels = have_models(kColumnsOf<C, F>);

  KINECAL_FLATTEN static void pose_only(const WalkStart<S>& start, const S* joints, Pose<S>& tip) {
    PoseWalker<S> walker;
    copy_numbers(start.pose, walker.pose);
    go_on(start, joints, walker);
    copy_numbers(walker.pose, tip);
  }
  KINECAL_FLATTEN static void with_twists(const WalkStart<S>& start, const S* joints,
                                          Pose<S>& tip) {
    TwistWalker<S, StaticColumns<C, F>> walker({}, start.turn, start.shift, start.pose);
    go_on(start, joints, walker);
    copy_numbers(walker.walker.pose, tip);
  }

 private:
  template <class W>
  static void go_on(const WalkStart<S>& start, const S* joints, W& walker) {
    walk_on<kModels>(C{}, C::kFirstMotion, JointStates<S, kModels>{joints},
                     std::span(start.corrections, C::kSize), walker);
  }
};

/// Compiles the walk of a chain.
/// @tparam C  a Chain
/// @tparam F  a FreeParameters
template <class S, StaticChain C, class F>
[[nodiscard]] CompiledWalk<S> compiled_walk() {
  const auto& columns = kColumnsOf<C, F>;
  const std::string_view tip = C::kVirtual.empty() ? C::kTip : C::kVirtual;
  return {std::string(tip),
          {columns.begin(), columns.end()},
          WalkOf<S, C, F>::kModels,
          &WalkOf<S, C, F>::pose_only,
          &WalkOf<S, C, F>::with_twists};
}

}  // namespace kinecal::detail
