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
  if (!Sensor::Chain::kHasLinks) return true;  // the chain's own check reports that
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

/// The name of number I of a free parameter: "camera_fx".
template <class P, std::size_t I>
struct NameOfNumber {
  static constexpr const ParameterId& kId = P::kIds[I];
  static constexpr std::size_t kSize =
      kId.owner.size() + (kId.part.empty() ? 0 : 1 + kId.part.size());
  static constexpr auto kLetters = [] {
    std::array<char, kSize> letters{};
    auto end = std::copy(kId.owner.begin(), kId.owner.end(), letters.begin());
    if (!kId.part.empty()) {
      *end++ = '_';
      std::copy(kId.part.begin(), kId.part.end(), end);
    }
    return letters;
  }();
  static constexpr std::string_view kName = {kLetters.data(), kSize};
};

/// On what a prior may be, for LookedUp: the frames that are free, and each free number.
template <class... Ps>
struct NamesForPriors {
  [[nodiscard]] static constexpr bool is_frame(ParameterKind kind) {
    return kind == ParameterKind::frame_offset || kind == ParameterKind::virtual_frame;
  }
  static constexpr auto kNames = [] {
    constexpr std::size_t kFrames = (std::size_t(0) + ... + (is_frame(Ps::kKind) ? 1 : 0));
    std::array<std::string_view, kFrames + FreeParameters<Ps...>::kSize> names;
    std::size_t n = 0;
    ((is_frame(Ps::kKind) ? void(names[n++] = Ps::kOwner) : void()), ...);
    const auto append = [&]<class P, std::size_t... I>(P*, std::index_sequence<I...>) {
      ((names[n++] = NameOfNumber<P, I>::kName), ...);
    };
    (append(static_cast<Ps*>(nullptr), std::make_index_sequence<Ps::kIds.size()>{}), ...);
    return names;
  }();
};

/// @tparam Found  the result of LookedUp: Known or DidYouMean
template <class Prior, class Found, bool kIsFree = false>
struct ParameterOfPrior {
  static_assert(kIsFree,
                "kinecal: the joint, frame or parameter in this PriorOn is not free in the crate; "
                "correct its name or leave the prior out");
};

/// Checks that what a prior keeps is free.
template <class Prior, class... Ps>
struct CheckPrior {
  using Found = LookedUp<Prior::kOf, NamesForPriors<Ps...>>;
  using type = Unless<Found::kExists, ParameterOfPrior<Prior, Found>>;
};

}  // namespace kinecal::detail
