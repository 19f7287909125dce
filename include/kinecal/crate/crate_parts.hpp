// The parts of a crate besides free parameters: sensors, error blocks and priors as types; type
// lists.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tuple>
#include <type_traits>

#include "kinecal/errors/error_block.hpp"
#include "kinecal/errors/prior.hpp"
#include "kinecal/kinematics/static_chain.hpp"
#include "kinecal/parameters/free_parameters.hpp"
#include "kinecal/problem/term.hpp"
#include "kinecal/sensors/chain_point.hpp"
#include "kinecal/sensors/depth/depth_camera.hpp"
#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal {

/// A sensor of any type at the tip of a chain.
/// @tparam M  the sensor: one of sensors/, or your own struct
template <FixedString Name, StaticChain C, class M>
struct SensorOn {
  using Chain = C;                                 ///< from the base to the sensor
  using Model = M;                                 ///< the sensor
  static constexpr std::string_view kName = Name;  ///< as in the samples

  /// Where it is mounted, for a Problem.
  [[nodiscard]] static Mount mount() { return {std::string(kName), std::string(C::kTip)}; }
};

/// Points at known positions in the chain's tip.
template <FixedString Name, StaticChain C>
struct Chain3d : SensorOn<Name, C, ChainPoint> {};
/// Points on several links, each the tip of a chain: the surface of the robot where a camera sees it, for PointToMesh and
/// PointToOutline.
///
///     Surface3d<"surface", Chain<arm::Robot, "base", "upper">, Chain<arm::Robot, "base", "fore">>
///
/// @tparam C     to the first link
/// @tparam More  to the others
template <FixedString Name, StaticChain C, StaticChain... More>
struct Surface3d : SensorOn<Name, C, ChainPoint> {
  using Further = std::tuple<More...>;  ///< chains to the other links

  /// Where it is, for a Problem.
  [[nodiscard]] static Mount mount() {
    Mount mount = SensorOn<Name, C, ChainPoint>::mount();
    mount.links = {std::string(More::kTip)...};
    return mount;
  }
};
/// Poses in the chain's tip.
template <FixedString Name, StaticChain C>
struct Chain6d : SensorOn<Name, C, ChainPose> {};
/// A depth camera; its optical frame is the chain's tip.
template <FixedString Name, StaticChain C>
struct Camera3d : SensorOn<Name, C, DepthCamera> {};
/// A camera; its optical frame is the chain's tip.
/// @tparam L  its lens: PlumbBob, Equidistant, ...; RationalPolynomial contains PlumbBob
template <FixedString Name, StaticChain C, LensModel L = RationalPolynomial>
struct Camera2d : SensorOn<Name, C, LensCamera<L>> {};

/// An error block between sensors, with a name, a sigma and a loss.  Both can be set later:
///
///     crate.block<"hand_eye">().options.sigma = 0.001;
///     crate.block<"hand_eye">().options.loss = {LossType::huber, 3.0};
///
/// @tparam B        the block: one of errors/, or your own struct
/// @tparam Sensors  names of the sensors that it compares
template <FixedString Name, class B, FixedString... Sensors>
struct Block {
  using Plain = Block;  ///< the base type, in a class that derives from this one to set options
  using Error = B;      ///< the error block
  static constexpr std::string_view kName = Name;  ///< of the block, for reports
  /// Names of the sensors, in the order of the block's arguments.
  static constexpr std::array<std::string_view, sizeof...(Sensors)> kSensorNames = {Sensors...};

  B error = {};              ///< the error block
  TermOptions options = {};  ///< sigma, loss, names
};

/// A prior on a joint's offset, a frame's correction or a single parameter ("camera_fx"): see
/// Prior.
template <FixedString Name, FixedString Of>
struct PriorOn {
  static constexpr std::string_view kName = Name;  ///< of the prior, for reports
  static constexpr std::string_view kOf = Of;      ///< name of the joint, frame or parameter

  double joint_scale = 1.0;                                   ///< see Prior
  double position_scale = 1.0;                                ///< 1 / m
  double rotation_scale = 1.0;                                ///< 1 / rad
  std::array<double, 7> mean = {};                            ///< see Prior
  TermOptions options = {.type = "outrageous", .unit = "1"};  ///< sigma, loss, names
};

/// A part of a crate that is a sensor.
template <class P>
concept SensorPart = requires {
  typename P::Chain;
  typename P::Model;
};
/// A part of a crate that is an error block.
template <class P>
concept BlockPart = requires {
  typename P::Error;
  P::kSensorNames;
};
/// A part of a crate that is a prior.
template <class P>
concept PriorPart = requires {
  P::kOf;
};

namespace detail {

template <class P>
struct ChainsOf {
  using type = std::tuple<typename P::Chain>;
};
template <class P>
requires requires {
  typename P::Further;
}
struct ChainsOf<P> {
  using type = decltype(std::tuple_cat(std::tuple<typename P::Chain>(), typename P::Further()));
};
/// True if a predicate holds for all chains of a sensor: to it, or to each link of Surface3d.
/// @param holds  takes std::type_identity<Chain>
template <SensorPart P, class Predicate>
[[nodiscard]] constexpr bool all_chains(const Predicate& holds) {
  return [&]<class... Cs>(std::type_identity<std::tuple<Cs...>>) {
    return (holds(std::type_identity<Cs>()) && ...);
  }(std::type_identity<typename ChainsOf<P>::type>());
}

/// Parts of one kind, without duplicates.
template <class... Ts>
struct TypeList {
  static constexpr std::size_t kSize = sizeof...(Ts);
  template <template <class...> class To>
  using As = To<Ts...>;
  /// Of sensors, blocks and priors; for LookedUp.
  static constexpr std::array<std::string_view, kSize> kNames = {Ts::kName...};

  /// True if no name occurs twice.
  [[nodiscard]] static constexpr bool names_differ() {
    return ((std::count(kNames.begin(), kNames.end(), Ts::kName) == 1) && ...);
  }
  /// Calls f(std::type_identity<T>()) for each type, in their order.
  template <class F>
  static constexpr void for_each(F&& f) {
    (f(std::type_identity<Ts>()), ...);
  }

  /// Appends new types only: a type, or the types of another list.
  template <class T>
  constexpr auto operator+(std::type_identity<T>) const {
    return std::conditional_t<(std::is_same_v<T, Ts> || ...), TypeList, TypeList<Ts..., T>>();
  }
  template <class... Others>
  constexpr auto operator+(TypeList<Others...>) const {
    return (TypeList() + ... + std::type_identity<Others>());
  }
};

/// The types of all lists, without duplicates.
template <class... Lists>
using Joined = decltype((TypeList<>() + ... + Lists()));

template <bool kTake, class T>
using OnlyIf = std::conditional_t<kTake, TypeList<T>, TypeList<>>;

/// The frames among free parameters.
template <class... Ps>
using FreeFrames = typename Joined<OnlyIf<is_frame(Ps::kKind), Ps>...>::template As<FreeParameters>;

}  // namespace detail

}  // namespace kinecal
