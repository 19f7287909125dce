// Joint models: the true position of a joint from what a sample says of it.
//
//   q = q_measured + offset + sum over parameters of  value * effect(sample)
//
// A model is a struct with the names of its parameters and one call operator, which gives their
// effects: by how much a unit of each moves the joint in a sample.  So the column of a parameter in
// the Jacobian is its effect times the twist of the joint.  Effects are computed once per sample.
//
// To add a model, write such a struct and call register_joint_model(), or list it in a crate:
//
//   struct Worm {  // an error of the worm gear, ten times a turn
//     static constexpr std::array<ParameterInfo, 2> kParameters = {{{"worm_sin", "rad"},
//                                                                   {"worm_cos", "rad"}}};
//     std::array<double, 2> operator()(const JointReading& joint) const {
//       return {std::sin(10.0 * joint.position()), std::cos(10.0 * joint.position()) - 1.0};
//     }
//   };
//
// Source: Hollerbach, Khalil, Gautier, Model Identification, Springer Handbook of Robotics, 6.2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "kinecal/kinematics/joint.hpp"
#include "kinecal/parameters/parameter.hpp"

namespace kinecal {

/// What a sample says of a joint, for its models.  What the sample does not say throws SampleError.
class JointReading {
 public:
  JointReading() = default;
  JointReading(const JointReading&) = delete;             ///< it refers to its sample
  JointReading& operator=(const JointReading&) = delete;  ///< it refers to its sample
  virtual ~JointReading() = default;

  /// Measured position, radians or metres; of a mimic joint, that of the joint that drives it.
  [[nodiscard]] virtual double position() const = 0;
  /// Measured position of another joint, radians or metres.
  [[nodiscard]] virtual double position_of(const std::string& joint) const = 0;
  /// Measured velocity, rad/s or m/s.
  [[nodiscard]] virtual double velocity() const = 0;
  /// Direction of the last motion: 1, -1, or 0 if it has not moved yet.
  [[nodiscard]] virtual double direction() const = 0;
  /// Gravity on the joint, with all links that it moves: torque about its axis, N m, or force along
  /// it, N; positive if it pulls towards larger positions.
  [[nodiscard]] virtual double load() const = 0;
  /// Gravity on the joint of one kilogram at the origin of a link; unit and sign as load().
  [[nodiscard]] virtual double load_of(const std::string& link) const = 0;
};

/// What the name of a model's parameter ends with, after the model's own: nothing, another joint
/// ("elbow_coupling_shoulder"), a link ("elbow_link_sag_gripper").
enum class ModelPartner { none, joint, link };

/// The partner of a model.
template <class M>
[[nodiscard]] constexpr ModelPartner partner_of() {
  if constexpr (requires { M::kPartner; }) return M::kPartner;
  return ModelPartner::none;
}
namespace detail {
/// What the call operator of a model returns; no type if it cannot be called.
template <class M, ModelPartner P>
struct EffectsOf : std::invoke_result<const M&, const JointReading&, const std::string&> {};
template <class M>
struct EffectsOf<M, ModelPartner::none> : std::invoke_result<const M&, const JointReading&> {};
}  // namespace detail

/// A joint model: names of parameters, and the effect of each in a sample.
template <class M>
concept JointModel = requires {
  M::kParameters.size();
  requires std::same_as < typename detail::EffectsOf < M, partner_of<M>()
  > ::type, std::array < double, M::kParameters.size() >> ;
};

/// A gear ratio that differs from the driver's: q = (1 + gear_ratio) q_measured.
struct GearRatio {
  static constexpr std::array<ParameterInfo, 1> kParameters = {
      {{"gear_ratio", "1"}}};                                          ///< relative
  static constexpr std::array<std::string_view, 1> kFormulas = {"q"};  ///< text of operator()
  /// True for joints that may have it.
  [[nodiscard]] static constexpr bool suits(JointType, bool is_mimic) { return !is_mimic; }
  /// What is added to the position per unit of each parameter.
  [[nodiscard]] std::array<double, 1> operator()(const JointReading& joint) const {
    return {joint.position()};
  }
};

/// An encoder disc mounted off center: its error is the first harmonic of the angle, zero at zero.
struct EccentricEncoder {
  static constexpr std::array<ParameterInfo, 2> kParameters = {
      {{"eccentric_sin", "rad"}, {"eccentric_cos", "rad"}}};  ///< amplitudes
  static constexpr std::array<std::string_view, 2> kFormulas = {
      "sin(q)", "(cos(q) - 1)"};  ///< text of operator()
  /// What is added to the position per unit of each parameter.
  [[nodiscard]] std::array<double, 2> operator()(const JointReading& joint) const {
    return {std::sin(joint.position()), std::cos(joint.position()) - 1.0};
  }
};

/// A tilted encoder disc, a shaft that is not round, a flexspline of two lobes: the second harmonic.
/// Source: Tuttle, Understanding and Modeling the Behavior of a Harmonic Drive Gear Transmission.
struct SecondHarmonic {
  static constexpr std::array<ParameterInfo, 2> kParameters = {
      {{"second_harmonic_sin", "rad"}, {"second_harmonic_cos", "rad"}}};  ///< amplitudes
  static constexpr std::array<std::string_view, 2> kFormulas = {
      "sin(2 q)", "(cos(2 q) - 1)"};  ///< text of operator()
  /// What is added to the position per unit of each parameter.
  [[nodiscard]] std::array<double, 2> operator()(const JointReading& joint) const {
    return {std::sin(2.0 * joint.position()), std::cos(2.0 * joint.position()) - 1.0};
  }
};

/// A gear that yields to gravity: compliance times load, by the masses in the URDF.
/// Source: Khalil, Besnard, Geometric Calibration of Robots with Flexible Joints and Links.
struct Sag {
  static constexpr std::array<ParameterInfo, 1> kParameters = {
      {{"sag", "rad/Nm"}}};  ///< compliance
  static constexpr std::array<std::string_view, 1> kFormulas = {
      "load (gravity about the axis, N m)"};    ///< text of operator()
  static constexpr bool kNeedsMasses = true;    ///< needs link masses in the URDF
  static constexpr bool kNeverNegative = true;  ///< parameters cannot be negative
  /// True for joints that may have it.
  [[nodiscard]] static constexpr bool suits(JointType, bool is_mimic) { return !is_mimic; }
  /// What is added to the position per unit of each parameter.
  [[nodiscard]] std::array<double, 1> operator()(const JointReading& joint) const {
    return {joint.load()};
  }
};

/// Sag under the unknown mass of one link, such as a tool: compliance times that mass.
struct LinkSag {
  static constexpr std::array<ParameterInfo, 1> kParameters = {
      {{"link_sag", "rad kg/Nm"}}};  ///< compliance times mass
  static constexpr std::array<std::string_view, 1> kFormulas = {
      "load of 1 kg there (N m)"};                              ///< text of operator()
  static constexpr ModelPartner kPartner = ModelPartner::link;  ///< the link with the mass
  static constexpr bool kNeverNegative = true;                  ///< parameters cannot be negative
  /// True for joints that may have it.
  [[nodiscard]] static constexpr bool suits(JointType, bool is_mimic) { return !is_mimic; }
  /// What is added to the position per unit of each parameter.
  [[nodiscard]] std::array<double, 1> operator()(const JointReading& joint,
                                                 const std::string& link) const {
    return {joint.load_of(link)};
  }
};

/// A joint that another one moves along: a wrist whose cable runs over the elbow, a parallelogram.
struct Coupling {
  static constexpr std::array<ParameterInfo, 1> kParameters = {{{"coupling", "1"}}};  ///< share
  static constexpr std::array<std::string_view, 1> kFormulas = {
      "q of that joint"};                                        ///< text of operator()
  static constexpr ModelPartner kPartner = ModelPartner::joint;  ///< the joint that moves it
  /// True for joints that may have it: all.
  [[nodiscard]] static constexpr bool suits(JointType, bool) { return true; }
  /// What is added to the position per unit of each parameter.
  [[nodiscard]] std::array<double, 1> operator()(const JointReading& joint,
                                                 const std::string& other) const {
    return {joint.position_of(other)};
  }
};

/// Play of a gear with its encoder on the motor: the joint lags by half of it.
struct Backlash {
  static constexpr std::array<ParameterInfo, 1> kParameters = {{{"backlash", "rad"}}};  ///< the gap
  static constexpr std::array<std::string_view, 1> kFormulas = {
      "(-1/2 after a motion up, 1/2 after one down)"};  ///< text of operator()
  static constexpr bool kNeverNegative = true;          ///< parameters cannot be negative
  /// True for joints that may have it.
  [[nodiscard]] static constexpr bool suits(JointType, bool is_mimic) { return !is_mimic; }
  /// What is added to the position per unit of each parameter.
  [[nodiscard]] std::array<double, 1> operator()(const JointReading& joint) const {
    return {-0.5 * joint.direction()};
  }
};

/// Play that gravity takes up: the joint rests on that side of the gap to which its load pulls.
struct LoadBacklash {
  static constexpr std::array<ParameterInfo, 1> kParameters = {
      {{"load_backlash", "rad"}}};  ///< gap
  static constexpr std::array<std::string_view, 1> kFormulas = {
      "(1/2 where gravity pulls up, else -1/2)"};  ///< text of operator()
  static constexpr bool kNeedsMasses = true;       ///< needs link masses in the URDF
  static constexpr bool kNeverNegative = true;     ///< parameters cannot be negative
  /// True for joints that may have it.
  [[nodiscard]] static constexpr bool suits(JointType, bool is_mimic) { return !is_mimic; }
  /// What is added to the position per unit of each parameter.
  [[nodiscard]] std::array<double, 1> operator()(const JointReading& joint) const {
    const double load = joint.load();
    return {load > 0.0 ? 0.5 : load < 0.0 ? -0.5 : 0.0};
  }
};

/// The multiplier and offset of a mimic joint, added to those of the URDF.
struct MimicErrors {
  static constexpr std::array<ParameterInfo, 2> kParameters = {
      {{"mimic_multiplier", "1"}, {"mimic_offset", "rad"}}};  ///< added to the URDF's
  static constexpr std::array<std::string_view, 2> kFormulas = {"q of the joint that it mimics",
                                                                "1"};  ///< text of operator()
  /// True for joints that may have it.
  [[nodiscard]] static constexpr bool suits(JointType, bool is_mimic) { return is_mimic; }
  /// What is added to the position per unit of each parameter.
  [[nodiscard]] std::array<double, 2> operator()(const JointReading& joint) const {
    return {joint.position(), 1.0};
  }
};

/// How much later a sensor measured than the joints: of each sensor, on all joints that move it.
struct SensorLag {
  static constexpr std::array<ParameterInfo, 1> kParameters = {{{"lag", "s"}}};  ///< the time
  /// What is added to the position per unit of each parameter.
  [[nodiscard]] std::array<double, 1> operator()(const JointReading& joint) const {
    return {joint.velocity()};
  }
};
/// Its parameter.
inline constexpr ParameterInfo kLag = SensorLag::kParameters[0];

/// The joint models that every program has.
using JointModels = std::tuple<GearRatio, EccentricEncoder, SecondHarmonic, Sag, LinkSag, Coupling,
                               Backlash, LoadBacklash, MimicErrors>;

/// The effect of a parameter as a formula of the reading q; empty if the model has none.
template <class M>
[[nodiscard]] constexpr std::string_view formula_of(std::size_t part) {
  if constexpr (requires { M::kFormulas; }) return M::kFormulas[part];
  return {};
}
/// True if a model needs the masses of the robot's links.
template <class M>
[[nodiscard]] constexpr bool needs_masses() {
  if constexpr (requires { M::kNeedsMasses; }) return M::kNeedsMasses;
  return false;
}
/// True if the parameters of a model are never negative: nothing rises under its load, and play has a
/// size.
template <class M>
[[nodiscard]] constexpr bool is_never_negative() {
  if constexpr (requires { M::kNeverNegative; }) return M::kNeverNegative;
  return false;
}
/// True if a joint of this type, which moves, may have a model; without suits(), rotating joints
/// that do not mimic another.
template <class M>
[[nodiscard]] constexpr bool suits_joint(JointType type, bool is_mimic) {
  if constexpr (requires { M::suits(type, is_mimic); }) return M::suits(type, is_mimic);
  return turns(type) && !is_mimic;
}

}  // namespace kinecal
