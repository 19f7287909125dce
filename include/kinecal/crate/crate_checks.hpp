// Compile-time checks of a crate as a whole; each fails with a sentence (sentence.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/use_checks.hpp"

namespace kinecal::detail {

struct NoRobot {
  static constexpr std::string_view kName = "";
  static constexpr std::array<JointData, 0> kJoints = {};
};
struct NoChain {
  using Robot = NoRobot;
  static constexpr std::string_view kBase = "";
};
/// The chain of the first sensor; the crate has its robot and base.
template <class Sensors>
struct FirstChain {
  using type = NoChain;
};
template <class S, class... Ss>
struct FirstChain<TypeList<S, Ss...>> {
  using type = typename S::Chain;
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

/// False if a chain is wrong; its own check reports that.
template <class C>
inline constexpr bool kHasBase = LookedUp<C::kBase, LinkNames<typename C::Robot>>::kExists;

template <class A, class B>
[[nodiscard]] constexpr bool start_together() {
  if (!kHasBase<A> || !kHasBase<B>) return true;
  return std::is_same_v<typename A::Robot, typename B::Robot> && A::kBase == B::kBase;
}

template <class Sensors, class Parameters, class Blocks, class Priors>
struct CheckCrate;
template <class... Ss, class... Ps, class... Bs, class... Qs>
struct CheckCrate<TypeList<Ss...>, TypeList<Ps...>, TypeList<Bs...>, TypeList<Qs...>> {
  using Sensors = TypeList<Ss...>;
  using Blocks = TypeList<Bs...>;
  using Priors = TypeList<Qs...>;
  using Free = FreeParameters<Ps...>;
  using Base = typename FirstChain<Sensors>::type;

  template <class P>
  static constexpr bool kIsUsed = (moves_block<P, Bs>(Sensors{}) || ...);

  using type = FirstOf<  //
      Unless<(sizeof...(Ss) > 0), SensorsOfCrate<Blocks>>,
      Unless<(sizeof...(Bs) > 0), BlocksOfCrate<Sensors>>,
      Unless<PartNames<Sensors>::differ(), NamesOfSensors<Sensors>>,
      Unless<PartNames<Blocks>::differ(), NamesOfBlocks<Blocks>>,
      Unless<PartNames<Priors>::differ(), NamesOfPriors<Priors>>,
      Unless<Free::are_distinct(), NamesOfParameters<Free>>,
      Unless<(start_together<Base, typename Ss::Chain>() && ...), BaseOfCrate<Sensors>>,
      typename CheckBlock<typename Bs::Plain, Sensors>::type...,
      typename CheckParameter<Ps, typename Base::Robot, Sensors, Blocks>::type...,
      Unless<kIsUsed<Ps>, UseOfParameter<Ps>>...,  //
      typename CheckPrior<Qs, Ps...>::type...>;
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
