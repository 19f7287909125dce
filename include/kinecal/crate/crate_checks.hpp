// Compile-time checks of a crate and its error blocks; each fails with a sentence (sentence.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/parameter_use.hpp"
#include "kinecal/errors/block_checks.hpp"
#include "kinecal/sensors/sensor_checks.hpp"

namespace kinecal::detail {

/// @tparam Found  the result of LookedUp: Known or DidYouMean
template <class Block, FixedString Sensor, class Found, bool kIsInCrate = false>
struct SensorOfBlock {
  static_assert(kIsInCrate,
                "kinecal: a sensor of this error block is not in the crate; add it or correct its "
                "name");
};
template <class Block, bool kFits = false>
struct NumberOfSensors {
  static_assert(kFits,
                "kinecal: this error block is given too many or too few sensors; it has one for "
                "each argument of its residual, and two for a pixel");
};
template <class Block, bool kFit = false>
struct KindsOfSensors {
  static_assert(kFit,
                "kinecal: this error block is given a sensor of the wrong kind, which does not "
                "deliver what its residual takes; a camera that predicts pixels stands second");
};

/// The quantities that an error block takes from its sensors; empty if it is not an error block.
template <class B>
inline constexpr std::array<Quantity, 0> kTaken = {};
template <ErrorBlock B>
inline constexpr auto kTaken<B> = kQuantities<B>;

/// True if a sensor delivers a quantity; false of what is not a sensor, which has its own sentence.
template <class M>
[[nodiscard]] constexpr bool can_deliver(Quantity quantity) {
  if constexpr (Sensor<M>) return delivers<M>(quantity);
  return false;
}
/// True if each sensor of a block delivers the quantity the block takes.
template <class Block, class... Sensors>
[[nodiscard]] constexpr bool kinds_fit(TypeList<Sensors...>) {
  const auto& names = Block::kSensorNames;
  const auto& taken = kTaken<typename Block::Error>;
  const auto delivers_it = [](std::string_view name, Quantity quantity) {
    return ((Sensors::kName == name && can_deliver<typename Sensors::Model>(quantity)) || ...);
  };
  return std::equal(names.begin(), names.end(), taken.begin(), taken.end(), delivers_it);
}

template <class Block, FixedString Sensor, class Found>
using CheckSensor = Unless<Found::kExists, SensorOfBlock<Block, Sensor, Found>>;

/// Checks that a block can compare its sensors.
template <class Block, class Sensors>
struct CheckBlock;
template <FixedString Name, class Residual, FixedString... Of, class Sensors>
struct CheckBlock<Block<Name, Residual, Of...>, Sensors> {
  using B = Block<Name, Residual, Of...>;
  using type = FirstOf<Unless<ErrorBlock<Residual>, WhyNoBlock<Residual>>,
                       CheckSensor<B, Of, LookedUp<kView<Of>, Sensors>>...,
                       Unless<sizeof...(Of) == kTaken<Residual>.size(), NumberOfSensors<B>>,
                       Unless<kinds_fit<B>(Sensors()), KindsOfSensors<B>>>;
};

template <class Part, bool kIsPart = false>
struct PartOfCrate {
  static_assert(kIsPart,
                "kinecal: this template argument is not a Crate part; parts are sensors, free "
                "parameters, Block, PriorOn and other crates");
};
template <class Blocks, bool kHasSensors = false>
struct SensorsOfCrate {
  static_assert(kHasSensors, "kinecal: this Crate has no sensors; add those of its blocks");
};
template <class Sensors, bool kHasBlocks = false>
struct BlocksOfCrate {
  static_assert(kHasBlocks, "kinecal: this Crate has no Block; add what is to be minimized");
};
template <class Sensors, bool kDiffer = false>
struct NamesOfSensors {
  static_assert(kDiffer,
                "kinecal: two sensors of this Crate have the same name; rename one of them");
};
template <class Blocks, bool kDiffer = false>
struct NamesOfBlocks {
  static_assert(kDiffer,
                "kinecal: two blocks of this Crate have the same name; rename one of them");
};
template <class Priors, bool kDiffer = false>
struct NamesOfPriors {
  static_assert(kDiffer,
                "kinecal: two priors of this Crate have the same name; rename one of them");
};
template <class Parameters, bool kDiffer = false>
struct NamesOfParameters {
  static_assert(kDiffer,
                "kinecal: a free parameter occurs twice in this Crate; leave one of them out");
};
template <class Sensors, bool kIsShared = false>
struct BaseOfCrate {
  static_assert(kIsShared,
                "kinecal: the chains of this Crate start at different links or belong to different "
                "robots; features are compared in one base, so give all chains the same one");
};

/// Stands for the chain in a crate without sensors.
struct NoChain {
  struct Robot {
    static constexpr std::string_view kName = "";
    static constexpr std::array<JointData, 0> kJoints = {};
  };
  static constexpr std::string_view kBase = "";
};
/// The chain of the first sensor; the crate uses its robot and base.
template <class... Sensors>
using FirstChain = std::tuple_element_t<0, std::tuple<typename Sensors::Chain..., NoChain>>;

template <class Sensors, class Parameters, class Blocks, class Priors>
struct CheckCrate;
template <class... Ss, class... Ps, class... Bs, class... Qs>
struct CheckCrate<TypeList<Ss...>, TypeList<Ps...>, TypeList<Bs...>, TypeList<Qs...>> {
  using Sensors = TypeList<Ss...>;
  using Blocks = TypeList<Bs...>;
  using Priors = TypeList<Qs...>;
  using Free = FreeParameters<Ps...>;
  using BaseChain = FirstChain<Ss...>;

  /// A wrong chain has its own sentence.
  template <class C>
  static constexpr bool kStartsThere =
      !C::kHasLinks || !BaseChain::kHasLinks ||
      (std::is_same_v<typename C::Robot, typename BaseChain::Robot> &&
       C::kBase == BaseChain::kBase);
  template <class Sensor>
  static constexpr bool kAllStartThere = all_chains<Sensor>([]<class C>(std::type_identity<C>) {
    return kStartsThere<C>;
  });
  template <class P>
  static constexpr bool kIsUsed = (moves_block<P, Bs>(Sensors()) || ...);

  using type = FirstOf<  //
      Unless<(sizeof...(Ss) > 0), SensorsOfCrate<Blocks>>, CheckSensorType<typename Ss::Model>...,
      Unless<(sizeof...(Bs) > 0), BlocksOfCrate<Sensors>>,
      Unless<Sensors::names_differ(), NamesOfSensors<Sensors>>,
      Unless<Blocks::names_differ(), NamesOfBlocks<Blocks>>,
      Unless<Priors::names_differ(), NamesOfPriors<Priors>>,
      Unless<Free::are_distinct(), NamesOfParameters<Free>>,
      Unless<(kAllStartThere<Ss> && ...), BaseOfCrate<Sensors>>,
      typename CheckBlock<typename Bs::Plain, Sensors>::type...,
      typename CheckParameter<Ps, typename BaseChain::Robot, Sensors, Blocks>::type...,
      Unless<kIsUsed<Ps>, UseOfParameter<Ps>>...,
      CheckPrior<Qs, LookedUp<Qs::kOf, NamesForPriors<Ps...>>>...>;
};

/// @tparam Found  the result of LookedUp: Known or DidYouMean
template <FixedString Name, class Found, bool kExists = false>
struct PartOfName {
  static_assert(kExists, "kinecal: the crate has no part of this name; correct the name");
};
template <class Parameter, class Found, bool kIsFree = false>
struct ValueOf {
  static_assert(
      kIsFree, "kinecal: this parameter is not free in the crate; add it there or ask for another");
};

}  // namespace kinecal::detail
