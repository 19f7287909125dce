// Joint models: the true position of a joint from the one that its encoder measured.
//
//   q = q_measured + offset + sum over models of  change(q_measured, parameters)
//
// A model is a struct with the names of its parameters and one templated call operator.  With all
// parameters zero it changes nothing.  Its column of the Jacobian is its derivative (by jets) times
// the joint's twist.  To add a model, write a struct and list it in JointModels.
// Source: Hollerbach, Khalil, Gautier, Model Identification, Springer Handbook of Robotics, 6.2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <string_view>
#include <tuple>
#include <utility>

#include "kinecal/geometry/jet.hpp"
#include "kinecal/kinematics/joint.hpp"
#include "kinecal/kinematics/joint_state.hpp"

namespace kinecal {

/// A gear ratio that differs from the driver's: q = (1 + gear_ratio) q_measured.
struct GearRatio {
  static constexpr std::array<std::string_view, 1> kParameters = {"gear_ratio"};  ///< relative
  static constexpr std::array<std::string_view, 1> kUnits = {"1"};                ///< of them
  static constexpr bool kRotatesOnly = false;  ///< sliding joints may have it

  /// The change of the position.
  template <class S>
  [[nodiscard]] S operator()(const S& q, const std::array<S, 1>& v) const {
    return q * v[0];
  }
};

/// An encoder disc mounted off center: its error is the first harmonic of the angle, zero at zero.
struct EccentricEncoder {
  static constexpr std::array<std::string_view, 2> kParameters = {"eccentric_sin",
                                                                  "eccentric_cos"};  ///< amplitudes
  static constexpr std::array<std::string_view, 2> kUnits = {"rad", "rad"};          ///< of them
  static constexpr bool kRotatesOnly = true;  ///< sliding joints do not have it

  /// The change of the position.
  template <class S>
  [[nodiscard]] S operator()(const S& q, const std::array<S, 2>& v) const {
    using std::cos, std::sin;
    return v[0] * sin(q) + v[1] * (cos(q) - S(1.0));
  }
};

/// All joint models.
using JointModels = std::tuple<GearRatio, EccentricEncoder>;

namespace detail {

template <class Models>
struct ModelParameters;
template <class... Models>
struct ModelParameters<std::tuple<Models...>> {
  static constexpr std::size_t kSize = (std::size_t(0) + ... + Models::kParameters.size());

  template <class T, class Of>
  [[nodiscard]] static constexpr std::array<T, kSize> list(Of&& of) {
    std::array<T, kSize> all{};
    std::size_t n = 0;
    const auto append = [&](const auto& of_model) {
      for (const T& one : of_model) all[n++] = one;
    };
    (append(of(Models{})), ...);
    return all;
  }
};

}  // namespace detail

/// Number of the parameters of all joint models.
inline constexpr std::size_t kJointModelSize = detail::ModelParameters<JointModels>::kSize;
/// Their names, after the joint's: "elbow_gear_ratio".
inline constexpr auto kJointModelNames =
    detail::ModelParameters<JointModels>::list<std::string_view>(
        [](auto m) { return m.kParameters; });
/// Their units for a joint that rotates.
inline constexpr auto kJointModelUnits =
    detail::ModelParameters<JointModels>::list<std::string_view>([](auto m) { return m.kUnits; });
/// True for parameters that only rotating joints have.
inline constexpr auto kJointModelRotatesOnly =
    detail::ModelParameters<JointModels>::list<bool>([](auto m) {
      std::array<bool, m.kParameters.size()> all{};
      for (bool& one : all) one = m.kRotatesOnly;
      return all;
    });

/// Values, columns or indices of the parameters of all joint models.
template <class T>
using OfJointModels = std::array<T, kJointModelSize>;

/// The change of a joint's position by all models.
/// @param q       measured position, radians or metres
/// @param values  of the parameters
template <class S>
[[nodiscard]] S joint_model_change(const S& q, const OfJointModels<S>& values) {
  S sum(0.0);
  std::size_t first = 0;
  const auto add = [&]<class Model>(const Model& model) {
    std::array<S, Model::kParameters.size()> own;
    for (S& value : own) value = values[first++];
    sum += model(q, own);
  };
  std::apply([&](const auto&... models) { (add(models), ...); }, JointModels{});
  return sum;
}

/// Derivatives of joint_model_change() by each parameter.  Not inline: few joints have models.
template <class S>
[[nodiscard, gnu::noinline]] OfJointModels<S> joint_model_derivatives(
    const S& q, const OfJointModels<S>& values) {
  using J = Jet<S, static_cast<int>(kJointModelSize)>;
  OfJointModels<J> jets;
  for (std::size_t k = 0; k < kJointModelSize; ++k) jets[k] = J(values[k], static_cast<int>(k));
  const J change = joint_model_change(J(q), jets);
  OfJointModels<S> derivatives;
  for (std::size_t k = 0; k < kJointModelSize; ++k) derivatives[k] = change.v(static_cast<int>(k));
  return derivatives;
}

/// What an encoder measured: the position of the joint that drives a joint.
/// @param drive     of the joint: see Mimic
/// @param position  of the joint as measured, radians or metres
template <class Drive, class S>
[[nodiscard]] S driving_position(const Drive& drive, const S& position) {
  return S((position - drive.offset) / drive.multiplier);
}

/// The state of a joint with models.
/// @param drive     of the joint: the joint that its encoder measures
/// @param measured  state of the joint, as measured
/// @param offset    of its position
/// @param values    of the parameters of the joint that drives it
template <class Drive, class S, class U>
[[nodiscard]] auto modelled_state(const Drive& drive, const JointState<S>& measured,
                                  const JointState<U>& offset, const OfJointModels<U>& values) {
  using R = Product<S, U>;
  OfJointModels<R> all;
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = R(values[k]);
  const R change = joint_model_change(R(driving_position(drive, measured.position)), all);
  return measured + offset + make_joint_state(R(change * drive.multiplier));
}

}  // namespace kinecal
