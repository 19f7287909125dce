// Compile-time checks of what a crate's free parameters move, and of its priors; each fails with a
// sentence (sentence.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/parameter_checks.hpp"

namespace kinecal::detail {

/// True if moving a parameter moves what a sensor observes.
template <class P, class Sensor>
[[nodiscard]] constexpr bool moves_sensor() {
  using Robot = typename Sensor::Chain::Robot;
  constexpr std::string_view owner = P::kOwner;
  if (P::kKind == ParameterKind::sensor) return Sensor::kName == owner;
  if (P::kKind == ParameterKind::virtual_frame) return !kIsInOwnFrame<typename Sensor::Model>;
  for (const std::size_t joint : Sensor::Chain::kPassed) {
    const JointData& passed = Robot::kJoints[joint];
    const bool is_it = P::kKind == ParameterKind::frame_offset
                           ? passed.name == owner
                           : drive_of(Robot::kJoints, passed).joint == owner;
    if (is_it) return true;
  }
  return false;
}

/// True if a parameter is a block's own, or moves what one of its sensors observes;
template <class P, class Block, class... Sensors>
[[nodiscard]] constexpr bool moves_block(TypeList<Sensors...>) {
  if (P::kKind == ParameterKind::block) return Block::kName == P::kOwner;
  const auto& names = Block::kSensorNames;
  return ((std::find(names.begin(), names.end(), Sensors::kName) != names.end() &&
           moves_sensor<P, Sensors>()) ||
          ...);
}

template <class Parameter, bool kResidualsDepend = false>
struct UseOfParameter {
  static_assert(kResidualsDepend,
                "kinecal: no residual depends on this free parameter, because no error block has a "
                "sensor that it moves; leave it out or add such a block");
};

/// The joints and frames that are free, for LookedUp.
template <class... Ps>
struct JointsAndFrames {
  [[nodiscard]] static constexpr bool is_one(ParameterKind kind) {
    return kind == ParameterKind::joint_offset || kind == ParameterKind::frame_offset ||
           kind == ParameterKind::virtual_frame;
  }
  static constexpr auto kNames = [] {
    std::array<std::string_view, (std::size_t(0) + ... + (is_one(Ps::kKind) ? 1 : 0))> names;
    std::size_t n = 0;
    ((is_one(Ps::kKind) ? void(names[n++] = Ps::kOwner) : void()), ...);
    return names;
  }();
};

/// @tparam Found  the result of LookedUp: Known or DidYouMean
template <class Prior, class Found, bool kIsFree = false>
struct ParameterOfPrior {
  static_assert(kIsFree,
                "kinecal: the joint or frame in this PriorOn is not free in the crate; correct its "
                "name or leave the prior out");
};

/// Checks that the joint or frame of a prior is free.
template <class Prior, class... Ps>
struct CheckPrior {
  using Found = LookedUp<Prior::kOf, JointsAndFrames<Ps...>>;
  using type = Unless<Found::kExists, ParameterOfPrior<Prior, Found>>;
};

}  // namespace kinecal::detail
