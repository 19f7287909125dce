// The walk of one chain, compiled for that chain and for what is free.
//
// A crate knows its chains while compiling; a problem that is filled from one goes this way instead
// of that of a RuntimeChain.  Both give the same.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/packet.hpp"
#include "kinecal/parameters/free_parameters.hpp"

namespace kinecal {

template <class S>
struct CompiledWalk {
  using Motions = std::span<const Motion<S>>;
  using CorrectionsOfJoints = std::span<const JointCorrection<double>>;

  std::string tip;                    ///< of the chain
  std::vector<JointIndices> columns;  ///< for which with_twists is compiled
  /// From the first motion on, where walk_to_first_motion() came to; gives the tip's pose.
  void (*pose_only)(Motions, CorrectionsOfJoints, const Pose<S>& first, Pose<S>& tip);
  /// The same with the twists that are found on the way, from `turn` and `shift` on.
  void (*with_twists)(Motions, CorrectionsOfJoints, const Pose<S>& first, Pose<S>& tip,
                      Twist<S>* turn, Vector3<S>* shift);
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
  using Motions = typename CompiledWalk<S>::Motions;
  using Corrections = typename CompiledWalk<S>::CorrectionsOfJoints;

  KINECAL_FLATTEN static void pose_only(Motions motions, Corrections corrections,
                                        const Pose<S>& first, Pose<S>& tip) {
    PoseWalker<S> walker{first};
    walk_on(C{}, C::kFirstMotion, motions, corrections, walker);
    tip = walker.pose;
  }
  KINECAL_FLATTEN static void with_twists(Motions motions, Corrections corrections,
                                          const Pose<S>& first, Pose<S>& tip, Twist<S>* turn,
                                          Vector3<S>* shift) {
    TwistWalker<S, StaticColumns<C, F>> walker({}, turn, shift, first);
    walk_on(C{}, C::kFirstMotion, motions, corrections, walker);
    tip = walker.walker.pose;
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
