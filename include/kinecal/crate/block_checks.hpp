// Compile-time checks of a crate's error blocks; each fails with a sentence (sentence.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate/crate_parts.hpp"
#include "kinecal/kinematics/known_name.hpp"
#include "kinecal/kinematics/sentence.hpp"

namespace kinecal::detail {

/// The names of parts, for LookedUp.
template <class List>
struct PartNames;
template <class... Parts>
struct PartNames<TypeList<Parts...>> {
  static constexpr std::array<std::string_view, sizeof...(Parts)> kNames = {Parts::kName...};

  [[nodiscard]] static constexpr std::size_t index(std::string_view name) {
    return static_cast<std::size_t>(std::find(kNames.begin(), kNames.end(), name) - kNames.begin());
  }
  /// True if no name occurs twice.
  [[nodiscard]] static constexpr bool differ() {
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      if (index(kNames[i]) != i) return false;
    }
    return true;
  }
};

/// True if the sensor of this name delivers what a block takes.
template <class... Sensors>
[[nodiscard]] constexpr bool sensor_delivers(std::string_view name, Quantity quantity,
                                             TypeList<Sensors...>) {
  bool result = false;
  (void)((Sensors::kName == name ? (result = delivers<typename Sensors::Model>(quantity), true)
                                 : false) ||
         ...);
  return result;
}

template <class Residual, bool kIsTemplated = false>
struct ResidualOfBlock {
  static_assert(kIsTemplated,
                "kinecal: this error block is not a residual templated on its scalar; write "
                "template <class S> Eigen::Matrix<S, N, 1> operator()(const Vector3<S>& p) const");
};
template <class Residual, bool kIsVector = false>
struct VectorOfBlock {
  static_assert(kIsVector,
                "kinecal: the residual of this error block is not a vector of fixed size in the "
                "scalar of its arguments; return an Eigen::Matrix<S, N, 1>");
};
template <class Residual, bool kAreDelivered = false>
struct ArgumentsOfBlock {
  static_assert(kAreDelivered,
                "kinecal: no sensors deliver the arguments of this error block; write template "
                "<class S> Eigen::Matrix<S, N, 1> operator()(const Vector3<S>& p) const, or "
                "declare its Inputs");
};

/// The result has the scalar of the points.
template <class R, class S>
concept InScalar = std::same_as<typename std::remove_cvref_t<R>::Scalar, S>;
/// A block that can be called with points in a scalar.
template <class B, class S>
concept CalledWithPoints = requires(const B& block, const Vector3<S>& p) {
  { block(p) } -> InScalar<S>;
}
|| requires(const B& block, const Vector3<S>& p) {
  { block(p, p) } -> InScalar<S>;
};

/// What is wrong with a block that is not an ErrorBlock.
template <class B>
using WhyNoBlock = std::conditional_t<
    CalledWithPoints<B, Probe>, VectorOfBlock<B>,
    std::conditional_t<CalledWithPoints<B, double>, ResidualOfBlock<B>, ArgumentsOfBlock<B>>>;

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
                "each argument "
                "of its residual, and two for a pixel");
};

template <class Block, bool kFit = false>
struct KindsOfSensors {
  static_assert(kFit,
                "kinecal: this error block is given a sensor of the wrong kind, which does not "
                "deliver what its residual takes; a camera that predicts pixels stands second");
};

template <ErrorBlock Residual>
[[nodiscard]] constexpr bool takes(std::size_t sensors) {
  return sensors == std::size_t(kSensors<Residual>);
}
template <class Residual>
[[nodiscard]] constexpr bool takes(std::size_t) {
  return true;  // a Residual that is not an ErrorBlock fails an earlier check
}

template <class Block, class Sensors>
[[nodiscard]] constexpr bool kinds_fit() {
  using Error = typename Block::Error;
  if constexpr (ErrorBlock<Error>) {
    if (!takes<Error>(Block::kSensorNames.size())) return true;  // an earlier check fails
    for (std::size_t i = 0; i < Block::kSensorNames.size(); ++i) {
      if (!sensor_delivers(
              Block::kSensorNames[i], kQuantities<Error>[i], Sensors {}))
        return false;
    }
  }
  return true;
}

template <class Block, FixedString Sensor, class Sensors>
struct CheckSensorOfBlock {
  using Found = LookedUp<kView<Sensor>, PartNames<Sensors>>;
  using type = Unless<Found::kExists, SensorOfBlock<Block, Sensor, Found>>;
};

/// Checks that a block can compare its sensors.
template <class Block, class Sensors>
struct CheckBlock;
template <FixedString Name, class Residual, FixedString... Of, class Sensors>
struct CheckBlock<Block<Name, Residual, Of...>, Sensors> {
  using B = Block<Name, Residual, Of...>;
  using type = FirstOf<Unless<ErrorBlock<Residual>, WhyNoBlock<Residual>>,
                       typename CheckSensorOfBlock<B, Of, Sensors>::type...,
                       Unless<takes<Residual>(sizeof...(Of)), NumberOfSensors<B>>,
                       Unless<kinds_fit<B, Sensors>(), KindsOfSensors<B>>>;
};

}  // namespace kinecal::detail
