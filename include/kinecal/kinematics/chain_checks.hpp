// Compile-time checks of a Chain; each fails with a sentence (sentence.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/kinematics/known_name.hpp"
#include "kinecal/kinematics/static_robot.hpp"
#include "kinecal/text/fixed_string.hpp"
#include "kinecal/text/sentence.hpp"

namespace kinecal::detail {

/// @tparam Found  the result of LookedUp: Known or DidYouMean
template <FixedString Base, class Found, bool kIsLink = false>
struct BaseOfChain {
  static_assert(kIsLink,
                "kinecal: the base of this Chain is not a link of the robot; correct its name");
};

template <FixedString Tip, class Found, bool kIsLink = false>
struct TipOfChain {
  static_assert(kIsLink,
                "kinecal: the tip of this Chain is not a link of the robot; correct its name");
};

template <FixedString Base, FixedString Tip, bool kTurnOrSlide = false>
struct JointsOfChain {
  static_assert(kTurnOrSlide,
                "kinecal: a joint of this Chain is floating or planar; chains take fixed, "
                "revolute, continuous and prismatic joints");
};

template <FixedString Joint, class Found, bool kIsJoint = false>
struct FrameOfChain {
  static_assert(kIsJoint,
                "kinecal: the robot has no joint of a name in the Names of this Chain; correct it");
};

/// Checks that the joints with a frame correction exist, if they are given as Names.
template <class R, class Frames>
struct CheckFrames {
  using type = Holds;
};
template <FixedString Joint, class Found>
using CheckFrame = Unless<Found::kExists, FrameOfChain<Joint, Found>>;
template <class R, FixedString... Joints>
struct CheckFrames<R, Names<Joints...>> {
  using type = FirstOf<CheckFrame<Joints, LookedUp<kView<Joints>, JointNames<R>>>...>;
};

}  // namespace kinecal::detail
