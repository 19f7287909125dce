// Compile-time checks that a crate's residuals depend on its free parameters, and that its priors
// restrict some; each fails with a sentence (sentence.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/parameter_checks.hpp"

namespace kinecal::detail {

template <class Parameter, bool kResidualsDepend = false>
struct UseOfParameter {
  static_assert(kResidualsDepend,
                "kinecal: no residual depends on this free parameter, because no error block has a "
                "sensor that it moves; leave it out or add such a block");
};

/// True if a parameter moves the tip of a chain.
template <class P, class C>
[[nodiscard]] constexpr bool moves_chain() {
  using Robot = typename C::Robot;
  if (!C::kHasLinks) return true;  // the chain's own check reports that
  for (const std::size_t i : C::kPassed) {
    const JointData& joint = Robot::kJoints[i];
    const bool moves_frame = P::kKind == ParameterKind::frame_offset;
    const auto moved = moves_frame ? joint.name : drive_of(Robot::kJoints, joint).joint;
    if (moved == P::kOwner || joint.name == P::kOwner) return true;
  }
  return false;
}

/// True if a parameter affects the observations of a sensor.
template <class P, class Sensor>
[[nodiscard]] constexpr bool moves_sensor() {
  if (P::kKind == ParameterKind::sensor) return Sensor::kName == P::kOwner;
  if (P::kKind == ParameterKind::virtual_frame) return !kIsInOwnFrame<typename Sensor::Model>;
  return !all_chains<Sensor>([]<class C>(std::type_identity<C>) { return !moves_chain<P, C>(); });
}

/// True if a parameter is a block's own, or affects the observations of one of its sensors.
template <class P, class Block, class... Sensors>
[[nodiscard]] constexpr bool moves_block(TypeList<Sensors...>) {
  if (P::kKind == ParameterKind::block) return Block::kName == P::kOwner;
  const auto& names = Block::kSensorNames;
  return ((std::find(names.begin(), names.end(), Sensors::kName) != names.end() &&
           moves_sensor<P, Sensors>()) ||
          ...);
}

/// @tparam Found  the result of LookedUp: Known or DidYouMean
template <class Prior, class Found, bool kIsFree = false>
struct ParameterOfPrior {
  static_assert(kIsFree,
                "kinecal: the joint, frame or parameter in this PriorOn is not free in the crate; "
                "correct its name or leave the prior out");
};

/// Names that a prior may restrict, for LookedUp: the free frames and each free number.
template <class... Ps>
struct NamesForPriors {
  static constexpr auto kNames = [] {
    constexpr auto kFrames = FreeFrames<Ps...>::kNames;
    constexpr auto kNumbers = FreeParameters<Ps...>::kIds;
    std::array<std::string_view, kFrames.size() + kNumbers.size()> names;
    auto end = std::copy(kFrames.begin(), kFrames.end(), names.begin());
    for (const ParameterId& id : kNumbers) *end++ = id.full_name;
    return names;
  }();
};

/// Checks that a prior restricts free parameters.
template <class Prior, class Found>
using CheckPrior = Unless<Found::kExists, ParameterOfPrior<Prior, Found>>;

}  // namespace kinecal::detail
