// The input of an error block as numbers: arguments, parameters and conditions; random, moved, in
// packets, in jets.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <tuple>
#include <vector>

#include "kinecal/testing/comparison.hpp"
#include "kinecal/testing/random_input.hpp"

namespace kinecal::detail {

/// The arguments of a block's call; for a pixel block only the pixel.
template <class B>
using CalledWith =
    std::conditional_t<PixelBlock<B>, Takes<Quantity::pixel>, typename InputsOf<B>::type>;

template <ErrorBlock B, class S, class Arguments = CalledWith<B>>
struct BlockInput;
/// Input of a block: its arguments as vectors of three numbers, its parameters and its conditions.
template <ErrorBlock B, class S, Quantity... Qs>
struct BlockInput<B, S, Takes<Qs...>> {
  static constexpr auto& kQuantities = Takes<Qs...>::kAll;
  static constexpr std::size_t kOwn = kParametersOfBlock<B>;
  static constexpr std::size_t kValues = (0 + ... + InputOf<Qs>::kValues);
  static constexpr int kArguments = (0 + ... + kInputVariables<Qs>);
  static constexpr int kVariables = kArguments + static_cast<int>(kOwn), kM = kResiduals<B>;

  std::array<Vector3<S>, kValues> values;
  OwnOf<B, S> own;
  ConditionsOf<B, S> conditions{};

  /// These arguments, and the initial values of the parameters.
  [[nodiscard]] static BlockInput of(const B& block, const Argument<Qs, S>&... arguments) {
    BlockInput input;
    [[maybe_unused]] Vector3<S>* next = input.values.data();
    ((InputOf<Qs>::to_base(Pose<S>{}, arguments, next), next += InputOf<Qs>::kValues), ...);
    const auto infos = parameters_of(block);
    for (std::size_t i = 0; i < kOwn; ++i) input.own[i] = infos[i].initial;
    return input;
  }
  /// Random arguments, and parameters within 0.1 of their initial values.
  [[nodiscard]] static BlockInput random(const B& block, RandomInput& random) {
    BlockInput input;
    [[maybe_unused]] Vector3<S>* next = input.values.data();
    ((randomize<Qs>(random, next), next += InputOf<Qs>::kValues), ...);
    const auto infos = parameters_of(block);
    for (std::size_t i = 0; i < kOwn; ++i) {
      const double near = infos[i].initial + random(-0.1, 0.1);
      input.own[i] = std::clamp(near, infos[i].lower, infos[i].upper);
    }
    for (S& condition : input.conditions) condition = S(random(-1.0, 1.0));
    return input;
  }
  /// One input per lane: from `first` on, wrapping around.
  [[nodiscard]] static BlockInput packed(std::span<const BlockInput<B, double>> inputs,
                                         std::size_t first) {
    BlockInput input;
    for (int i = 0; i < kLanes<S>; ++i) {
      const auto& in_lane = inputs[(first + static_cast<std::size_t>(i)) % inputs.size()];
      for (std::size_t n = 0; n < kValues; ++n) {
        for (int k = 0; k < 3; ++k) set_lane(input.values[n](k), i, in_lane.values[n](k));
      }
      for (std::size_t n = 0; n < kOwn; ++n) set_lane(input.own[n], i, in_lane.own[n]);
      for (std::size_t n = 0; n < input.conditions.size(); ++n) {
        set_lane(input.conditions[n], i, in_lane.conditions[n]);
      }
    }
    return input;
  }

  /// The residual.
  [[nodiscard]] Eigen::Matrix<S, kM, 1> residual(const B& block) const {
    const Vector3<S>* next = values.data();
    [[maybe_unused]] const auto take = [&]<Quantity Q>(std::integral_constant<Quantity, Q>) {
      next += InputOf<Q>::kValues;
      return InputOf<Q>::template plain<S>(next - InputOf<Q>::kValues);
    };
    // In braces: evaluates the arguments from left to right.
    const std::tuple<Argument<Qs, S>...> arguments{take(std::integral_constant<Quantity, Qs>{})...};
    return std::apply(
        [&](const auto&... a) { return call_block<B, S>(block, own, conditions, a...); },
        arguments);
  }
  /// The residual and its derivatives by arguments and parameters, from jets.
  [[nodiscard]] Differentiated<S, kM, kVariables> differentiate(const B& block) const {
    using J = Jet<S, kVariables>;
    const Vector3<S>* next = values.data();
    int first = 0;
    [[maybe_unused]] const auto take = [&]<Quantity Q>(std::integral_constant<Quantity, Q>) {
      next += InputOf<Q>::kValues;
      first += kInputVariables<Q>;
      return InputOf<Q>::template jets<J>(next - InputOf<Q>::kValues, first - kInputVariables<Q>);
    };
    const std::tuple<Argument<Qs, J>...> arguments{take(std::integral_constant<Quantity, Qs>{})...};
    std::array<J, kOwn> parameters;
    for (std::size_t i = 0; i < kOwn; ++i) {
      parameters[i] = J(own[i], kArguments + static_cast<int>(i));
    }
    const Eigen::Matrix<J, kM, 1> r = std::apply(
        [&](const auto&... a) { return call_block<B, J>(block, parameters, conditions, a...); },
        arguments);
    return Differentiated<S, kM, kVariables>(r);
  }

  /// The input with variable k moved by a step.
  [[nodiscard]] BlockInput moved(int k, double step) const {
    BlockInput input = *this;
    if (k >= kArguments) {
      input.own[static_cast<std::size_t>(k - kArguments)] += step;
      return input;
    }
    Vector3<S>* next = input.values.data();
    [[maybe_unused]] const auto move = [&]<Quantity Q>(std::integral_constant<Quantity, Q>) {
      if (k >= 0 && k < kInputVariables<Q>) move_variable<Q>(next, k, step);
      next += InputOf<Q>::kValues;
      k -= kInputVariables<Q>;
    };
    (move(std::integral_constant<Quantity, Qs>{}), ...);
    return input;
  }
  /// The arguments, one vector of three numbers per line, then the parameters.
  [[nodiscard]] std::string text() const {
    Eigen::MatrixXd vectors(kValues, 3), parameters(1, kOwn);
    for (std::size_t i = 0; i < kValues; ++i) vectors.row(i) = values[i].transpose();
    for (std::size_t i = 0; i < kOwn; ++i) parameters(0, i) = own[i];
    return Named{"arguments", vectors}.text() +
           (kOwn > 0 ? Named{"parameters", parameters}.text() : "");
  }
};

}  // namespace kinecal::detail
