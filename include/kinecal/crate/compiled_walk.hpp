// The walk of one chain, compiled for that chain and for what is free.
//
// A crate knows its chains while compiling; a problem that is filled from one goes this way instead
// of that of a RuntimeChain.  Both give the same.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/packet.hpp"
#include "kinecal/parameters/free_parameters.hpp"

namespace kinecal {

/// Where a chain's walk goes on after what is the same for all samples of an evaluation.
template <class S>
struct WalkStart {
  Pose<S> pose;                                          ///< in front of the first motion
  std::size_t joint = 0;                                 ///< that moves so
  const JointCorrection<double>* corrections = nullptr;  ///< of all joints
  Twist<S>* turn = nullptr;     ///< where the twists go that are found from here on, if they
  Vector3<S>* shift = nullptr;  ///< are wanted
};

template <class S>
struct CompiledWalk {
  /// From there on; gives the tip's pose.
  /// @param motions  of all joints
  using Walk = void (*)(const WalkStart<S>&, const Motion<S>* motions, Pose<S>& tip);

  std::string tip;                    ///< of the chain
  std::vector<JointIndices> columns;  ///< for which with_twists is compiled
  Walk pose_only, with_twists;
};

namespace detail {

/// Slots as constants.
template <class C, class F>
struct StaticColumns {
  [[nodiscard]] constexpr const JointIndices& operator[](std::size_t joint) const {
    return kColumnsOf<C, F>[joint];
  }
};

template <class S, class C, class F>
struct WalkOf {
  KINECAL_FLATTEN static void pose_only(const WalkStart<S>& start, const Motion<S>* motions,
                                        Pose<S>& tip) {
    PoseWalker<S> walker{start.pose};
    go_on(start, motions, walker);
    tip = walker.pose;
  }
  KINECAL_FLATTEN static void with_twists(const WalkStart<S>& start, const Motion<S>* motions,
                                          Pose<S>& tip) {
    TwistWalker<S, StaticColumns<C, F>> walker({}, start.turn, start.shift, start.pose);
    go_on(start, motions, walker);
    tip = walker.walker.pose;
  }

 private:
  template <class W>
  static void go_on(const WalkStart<S>& start, const Motion<S>* motions, W& walker) {
    walk_on(C{}, C::kFirstMotion, std::span(motions, C::kSize),
            std::span(start.corrections, C::kSize), walker);
  }
};

}  // namespace detail

/// @tparam C  a chain
/// @tparam F  the FreeParameters
template <class S, StaticChain C, class F>
[[nodiscard]] CompiledWalk<S> compiled_walk() {
  const auto& columns = kColumnsOf<C, F>;
  const std::string_view tip = C::kVirtual.empty() ? C::kTip : C::kVirtual;
  return {std::string(tip),
          {columns.begin(), columns.end()},
          &detail::WalkOf<S, C, F>::pose_only,
          &detail::WalkOf<S, C, F>::with_twists};
}

}  // namespace kinecal
