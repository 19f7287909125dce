// The concept of an error block: a small residual function, templated on the scalar.
//
// A block takes a feature of each of its sensors, transformed to the base, and returns its
// residual.  Jets differentiate the block; twists propagate the derivative to joints and frames.
// So a new error block is a struct with the unit of its residual ("m", "px" or "1") and one templated call
// operator:
//
//   struct PointToSphere {
//     static constexpr const char* kUnit = "m";
//     Vector3<double> center;
//     double radius;
//     template <class S>
//     Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base) const {
//       return Eigen::Matrix<S, 1, 1>((p_base - center).norm() - radius);
//     }
//   };
//
// Its arguments, one per sensor:
//
//   Vector3<S>            a point in the base, one to four of them
//   Pose<S>, Ray<S>       poses or lines of sight in the base, one or two of them
//   PixelObservation<S>   a pixel: of two sensors, the second one is a camera that should see the
//                         point of the first one there
//   Plane<S>, Plane<S>    the planes through all features of two sensors
//
// Declare other combinations, and readings: `using Inputs = Takes<Quantity::point,
// Quantity::reading>;`.  All sensors of a block observe the same features in the same order.
//
// A block may have its own parameters.  Their values are its last argument:
//
//   static constexpr std::array kParameters = {ParameterInfo{"radius", "m", 0.1}};
//   template <class S> auto operator()(const Vector3<S>& p, const std::array<S, 1>& own) const;
//
// Define initial() if their initial values are not constants.
//
// A block may also take numbers of a feature, such as the normal of a wall there, or of its sample, such as a
// temperature.  They are its last argument, in a plain scalar:
//
//   static constexpr std::array<std::string_view, 4> kConditions = {"nx", "ny", "nz", "temperature"};
//   template <class S, class Q>
//   auto operator()(const Vector3<S>& p, const std::array<Q, 4>& conditions) const;
//
// Each is looked up in Feature::conditions of the block's sensors, in their order, then in Sample::conditions, then in the
// measured positions of joints; "before left_wheel" is what left_wheel was in the sample before (Sample::before).  Blocks
// of planes take those of the sample.
//
// A block without a sensor has one residual vector in each sample that has its conditions: wheels against the way that
// they went, a scale against a load.  It has own parameters, and no other argument:
//
//   struct Rollout {  // metres of a wheel's turn
//     static constexpr const char* kUnit = "m";
//     static constexpr std::array kParameters = {ParameterInfo{"radius", "m", 0.1}};
//     static constexpr std::array<std::string_view, 3> kConditions = {"way", "wheel", "before wheel"};
//     template <class S, class Q>
//     Eigen::Matrix<S, 1, 1> operator()(const std::array<S, 1>& own, const std::array<Q, 3>& c) const {
//       return Eigen::Matrix<S, 1, 1>(own[0] * (c[1] - c[2]) - c[0]);
//     }
//   };
//
// A scalar may be a packet with one sample per lane, so a block must not branch on values: write
// select(x < y, a, b) instead of x < y ? a : b.  (Planes are compared sample by sample; their
// blocks may branch.)
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "kinecal/parameters/parameter.hpp"
#include "kinecal/sensors/quantity_vectors.hpp"

namespace kinecal {

/// The quantities that a block takes from its sensors, in order.
template <Quantity... Qs>
struct Takes {
  static constexpr std::array<Quantity, sizeof...(Qs)> kAll = {Qs...};  ///< by sensor
};

namespace detail {

using Probe = Jet<double, 1>;

template <class B>
[[nodiscard]] consteval std::size_t count_own() {
  if constexpr (requires { B::kParameters; }) return B::kParameters.size();
  return 0;
}
template <class B>
[[nodiscard]] consteval auto condition_names() {
  if constexpr (requires { B::kConditions; }) {
    std::array<std::string_view, B::kConditions.size()> names;
    std::copy(B::kConditions.begin(), B::kConditions.end(), names.begin());
    return names;
  } else {
    return std::array<std::string_view, 0>{};
  }
}

/// The argument of a block for a quantity.
template <Quantity Q, class S>
struct ArgumentOf {
  using type = typename VectorsOf<Q>::template Type<S>;
};
template <class S>
struct ArgumentOf<Quantity::pixel, S> {
  using type = PixelObservation<S>;
};
template <class S>
struct ArgumentOf<Quantity::plane, S> {
  using type = Plane<S>;
};
template <Quantity Q, class S>
using Argument = typename ArgumentOf<Q, S>::type;

template <class R>
inline constexpr bool kIsResidualVector = false;
template <int N>
inline constexpr bool kIsResidualVector<Eigen::Matrix<Probe, N, 1>> = N > 0;
/// A vector of fixed size in the scalar of the points.  A block that is not templated returns
/// another scalar; one that returns `auto` may return an expression.
template <class R>
concept ResidualVector = kIsResidualVector<std::remove_const_t<R>>;

}  // namespace detail

/// Number of a block's own parameters: the size of B::kParameters, if it has them.
template <class B>
inline constexpr std::size_t kParametersOfBlock = detail::count_own<B>();
/// Names of the conditions of a feature or its sample that a block takes: B::kConditions, if it has them.
template <class B>
inline constexpr auto kConditionsOfBlock = detail::condition_names<B>();

namespace detail {

/// Own parameters of a block in S, and conditions in its plain scalar.
template <class B, class S>
using OwnOf = std::array<S, kParametersOfBlock<B>>;
template <class B, class S>
using ConditionsOf = std::array<kinecal::ValueOf<S>, kConditionsOfBlock<B>.size()>;

/// A block without own parameters and conditions.
template <class B>
inline constexpr bool kTakesFeaturesOnly = kParametersOfBlock<B> == 0 &&
                                           kConditionsOfBlock<B>.empty();

/// The trailing arguments of a block, as a tuple: its own parameters and conditions, if any.
template <class B, class S>
[[nodiscard]] constexpr auto further(const OwnOf<B, S>& own, const ConditionsOf<B, S>& conditions) {
  const auto if_any = [](const auto& all) {
    if constexpr (std::tuple_size_v < std::remove_cvref_t < decltype(all) >>> 0) {
      return std::tie(all);
    } else {
      return std::tuple<>();
    }
  };
  return std::tuple_cat(if_any(own), if_any(conditions));
}

/// Calls a block with its arguments and trailing arguments.
template <class B, class S, class... Arguments>
[[nodiscard]] auto call_block(const B& block, const OwnOf<B, S>& own,
                              const ConditionsOf<B, S>& conditions, const Arguments&... arguments) {
  return std::apply([&](const auto&... more) { return block(arguments..., more...); },
                    further<B, S>(own, conditions));
}

/// The return type of such a call, from the signature only: a block is not compiled for a scalar
/// that is never used.
template <class B, class Further, class... Arguments>
struct CallOf;
template <class B, class... Further, class... Arguments>
struct CallOf<B, std::tuple<Further...>, Arguments...>
    : std::invoke_result<const B&, const Arguments&..., Further...> {};
template <class B, class... Arguments>
using ResultOfCall =
    typename CallOf<B,
                    decltype(further<B, Probe>(std::declval<OwnOf<B, Probe>>(),
                                               std::declval<ConditionsOf<B, Probe>>())),
                    Arguments...>::type;

/// The result of a block for its inputs; no type if it does not take them.
template <class B, class Inputs>
struct ResultFor {};
template <class B, Quantity... Qs>
requires(sizeof...(Qs) > 0) && requires {
  typename ResultOfCall<B, Argument<Qs, Probe>...>;
}
struct ResultFor<B, Takes<Qs...>> : std::type_identity<ResultOfCall<B, Argument<Qs, Probe>...>> {};
/// Evaluation keeps the point: a block receives only the pixel.
template <class B>
requires requires {
  typename ResultOfCall<B, PixelObservation<Probe>>;
}
struct ResultFor<B, Takes<Quantity::point, Quantity::pixel>>
    : std::type_identity<ResultOfCall<B, PixelObservation<Probe>>> {};

/// A block without a sensor, which needs parameters to find and conditions to find them from.
template <class B>
requires requires {
  typename ResultOfCall<B>;
} &&(kParametersOfBlock<B> > 0) && (!kConditionsOfBlock<B>.empty())  //
    struct ResultFor<B, Takes<>> : std::type_identity<ResultOfCall<B>> {
};

/// A block that takes these inputs, whatever it returns.
template <class B, class Inputs>
concept TakesInputs = requires {
  typename ResultFor<B, Inputs>::type;
};
/// A block that returns a residual for these inputs.
template <class B, class Inputs>
concept ReturnsResidualFor = ResidualVector<typename ResultFor<B, Inputs>::type>;

struct NoInputs {};
template <class B, class... Candidates>
struct FirstTaken {
  using type = NoInputs;
  static constexpr bool kTakesSome = false;  ///< of the candidates, whatever it returns
};
template <class B, class First, class... Rest>
struct FirstTaken<B, First, Rest...>
    : std::conditional_t<ReturnsResidualFor<B, First>, std::type_identity<First>,
                         FirstTaken<B, Rest...>> {
  static constexpr bool kTakesSome = TakesInputs<B, First> || FirstTaken<B, Rest...>::kTakesSome;
};

template <class B>
struct InputsOf
    : FirstTaken<B, Takes<Quantity::point>, Takes<Quantity::point, Quantity::point>,
                 Takes<Quantity::point, Quantity::pixel>, Takes<Quantity::plane, Quantity::plane>,
                 Takes<Quantity::point, Quantity::point, Quantity::point>,
                 Takes<Quantity::point, Quantity::point, Quantity::point, Quantity::point>,
                 Takes<Quantity::pose>, Takes<Quantity::pose, Quantity::pose>, Takes<Quantity::ray>,
                 Takes<Quantity::ray, Quantity::ray>, Takes<>> {};
template <class B>
requires requires {
  typename B::Inputs;
}
struct InputsOf<B> : FirstTaken<B, typename B::Inputs> {};

/// The block returns a residual for what some sensors deliver.
template <class B>
concept IsResidualOfSensors = !std::same_as<typename InputsOf<B>::type, NoInputs>;
/// A block that is called with what sensors deliver returns an Eigen::Matrix<S, N, 1> of fixed size,
/// in the scalar S of its arguments: no expression (auto), array or number.
template <class B>
concept ReturnsVectorOfFixedSize = IsResidualOfSensors<B> || !InputsOf<B>::kTakesSome;

}  // namespace detail

/// A residual of the observations of up to four sensors.
template <class B>
concept ErrorBlock = detail::ReturnsVectorOfFixedSize<B> && detail::IsResidualOfSensors<B>;

/// The own parameters of a block, with their initial values.
template <class B>
[[nodiscard]] std::array<ParameterInfo, kParametersOfBlock<B>> parameters_of(const B& block) {
  std::array<ParameterInfo, kParametersOfBlock<B>> infos{};
  if constexpr (kParametersOfBlock<B> != 0) infos = B::kParameters;
  if constexpr (requires { block.initial(); }) {
    for (std::size_t i = 0; i < infos.size(); ++i) infos[i].initial = block.initial()[i];
  }
  return infos;
}

/// The quantities that a block takes from its sensors.
template <ErrorBlock B>
inline constexpr const auto& kQuantities = detail::InputsOf<B>::type::kAll;
/// Number of sensors that a block compares; one for a point compared with a constant, none for conditions alone.
template <ErrorBlock B>
inline constexpr int kSensors = static_cast<int>(kQuantities<B>.size());

/// block(p): p is a feature of one sensor, metres, in the base.
template <class B>
concept PointBlock = std::same_as<typename detail::InputsOf<B>::type, Takes<Quantity::point>>;
/// block(p_a, p_b): the same feature observed by two sensors, metres, in the base.
template <class B>
concept PointPairBlock =
    std::same_as<typename detail::InputsOf<B>::type, Takes<Quantity::point, Quantity::point>>;
/// block(pixel): a camera's pixel of a feature of another sensor.
template <class B>
concept PixelBlock =
    std::same_as<typename detail::InputsOf<B>::type, Takes<Quantity::point, Quantity::pixel>>;
/// block(a, b): the planes through all features of two sensors, in the base.
template <class B>
concept PlanePairBlock =
    std::same_as<typename detail::InputsOf<B>::type, Takes<Quantity::plane, Quantity::plane>>;

/// Number of residuals of one feature, or of one pair of planes.
template <ErrorBlock B>
inline constexpr int kResiduals =
    detail::ResultFor<B, typename detail::InputsOf<B>::type>::type::RowsAtCompileTime;

namespace detail {
/// A translation and a rotation.
template <class B>
inline constexpr bool kIsPoseDifference = kResiduals<B> == 6;
}  // namespace detail

/// A block whose residuals are a translation and a rotation, each times its scale: they are judged as a distance and an
/// angle.
template <class B>
concept ScaledPoseBlock = ErrorBlock<B> && detail::kIsPoseDifference<B> &&
    requires(const B& block) {
  { block.translation_scale } -> std::convertible_to<double>;  // 1 / metre
  { block.rotation_scale } -> std::convertible_to<double>;     // 1 / radian
};

}  // namespace kinecal
