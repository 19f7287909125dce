// The concept of a sensor: turns a measurement into a point, a ray, a pose or a reading in its own
// frame, for given parameters.
//
// A sensor is a small value type.  Jets differentiate it by its parameters; twists propagate the
// derivative to joints and frames.  So a new sensor is a struct with one or two functions:
//
//   struct DrawWire {  // a wire that is pulled out of a drum at the sensor's frame
//     static constexpr std::string_view kType = "draw_wire";
//     static constexpr std::array kParameters = {ParameterInfo{"scale"}, ParameterInfo{"zero", "m"}};
//     template <class S, class Q>
//     Reading<S> place(const Measurement<DrawWire, Q>& m, const std::array<S, 2>& v) const {
//       return {.value = m.point.x() * (1.0 + v[0]) + v[1]};
//     }
//   };
//
// A camera may also, or instead, predict the pixel of a point.  A sensor may also define:
//
//   kSettings, settings(observation)     numbers that come with each observation: intrinsics
//   initial(settings)                    values of its parameters before the first step
//   measurement(point, settings)         the part of a recorded point to keep, computed once
//   kUsuallyFree, with_held(s, v)        so many parameters suffice; settings with the values of the others
//   kOwnFrame                            features are in the sensor's frame, never in a virtual one
//   kOriented                            features have an orientation
//   predict(p, settings, parameters)     the pixel of a point in its frame: (2) pixels; not a number
//                                        where the camera does not see the point
//   sees(p)                              false where the formula of predict() gives a pixel, but the
//                                        camera does not see the point: z <= 0 of a pinhole.  A mask
//                                        for packets: `return p.z() > S(0.0);`
//   calibrated(camera_info, parameters)  makes it a camera: its camera_info with corrected intrinsics;
//                                        its settings begin with fx fy cx cy
//   image                                a member of type ImageKind: raw or rectified images
//   Corrected<Q>                         its own derivatives, in place of those by jets
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/parameters/parameter.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/quantity_vectors.hpp"

namespace kinecal {

/// An observation whose settings a sensor cannot use.
struct SettingsError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Where a sensor is mounted on the robot, and its names.
struct Mount {
  std::string name;                     ///< of the sensor, as in the samples
  std::string frame;                    ///< the link to which it is fixed
  std::string param_name = {};          ///< prefix of its parameters; empty: its name
  std::vector<std::string> links = {};  ///< further links in which its features may be given

  /// Prefix of its parameters: "camera" of "camera_fx".
  [[nodiscard]] const std::string& parameter_prefix() const {
    return param_name.empty() ? name : param_name;
  }
};

namespace detail {

template <class M>
[[nodiscard]] consteval std::size_t count_parameters() {
  if constexpr (requires { M::kParameters; }) return M::kParameters.size();
  return 0;
}
template <class M>
[[nodiscard]] consteval std::size_t count_settings() {
  if constexpr (requires { M::kSettings; }) return M::kSettings;
  return 0;
}
template <class M>
[[nodiscard]] consteval bool is_in_own_frame() {
  if constexpr (requires { M::kOwnFrame; }) return M::kOwnFrame;
  return false;
}
template <class M>
[[nodiscard]] consteval bool is_oriented() {
  if constexpr (requires { M::kOriented; }) return M::kOriented;
  return false;
}

}  // namespace detail

/// Number of a sensor's own parameters: the size of M::kParameters, if it has them.
template <class M>
inline constexpr std::size_t kParametersOf = detail::count_parameters<M>();
/// Number of settings that come with each observation, M::kSettings: a camera's intrinsics.
template <class M>
inline constexpr std::size_t kSettingsOf = detail::count_settings<M>();
/// Number of its first parameters that are usually free, M::kUsuallyFree: all of them without it.
template <class M>
inline constexpr std::size_t kUsuallyFreeOf = [] {
  if constexpr (requires { M::kUsuallyFree; }) return M::kUsuallyFree;
  return kParametersOf<M>;
}();
/// True if features are in the sensor's own frame, never in a virtual one: M::kOwnFrame.
template <class M>
inline constexpr bool kIsInOwnFrame = detail::is_in_own_frame<M>();
/// True if a feature has an orientation, M::kOriented.
template <class M>
inline constexpr bool kIsOriented = detail::is_oriented<M>();

/// One measured feature with the settings of its observation.
/// @tparam Q  scalar: a double, or a packet of several samples
template <class M, class Q>
struct Measurement {
  Vector3<Q> point = Vector3<Q>::Zero();         ///< (3) as recorded, or as M::measurement() gives
  Matrix3<Q> rotation = Matrix3<Q>::Identity();  ///< (3 x 3) of an oriented sensor
  std::array<Q, kSettingsOf<M>> settings = {};   ///< of the observation
};

namespace detail {

using Probe = Jet<double, 1>;

template <class M, class S = Probe>
using Placed = decltype(std::declval<const M&>().place(
    std::declval<const Measurement<M, double>&>(),
    std::declval<const std::array<S, kParametersOf<M>>&>()));
template <class M, Quantity Q>
concept PlacesOne = requires {
  typename Placed<M>;
}
&&std::same_as<Placed<M>, typename VectorsOf<Q>::template Type<Probe>>;
template <class M, class S = Probe>
using Predicted = decltype(std::declval<const M&>().predict(
    std::declval<const Vector3<S>&>(), std::declval<const std::array<double, kSettingsOf<M>>&>(),
    std::declval<const std::array<S, kParametersOf<M>>&>()));

}  // namespace detail

/// A sensor that delivers a quantity in its frame: place(measurement, parameters).
template <class M>
concept PlacingSensor =
    detail::PlacesOne<M, Quantity::point> || detail::PlacesOne<M, Quantity::ray> ||
    detail::PlacesOne<M, Quantity::pose> || detail::PlacesOne<M, Quantity::reading>;

/// A camera that predicts the pixel of a point: predict(p, settings, parameters).
template <class M>
concept PredictingSensor = requires {
  typename detail::Predicted<M>;
}
&&std::same_as<detail::Predicted<M>, Eigen::Matrix<detail::Probe, 2, 1>>;

/// A camera that states which points of its frame it sees: sees(p).
template <class M>
concept HasFieldOfView = requires(const M& model, const Vector3<double>& p) {
  { model.sees(p) } -> std::same_as<bool>;
};

namespace detail {

/// place(), if it takes a measurement, returns a quantity: no expression (auto), array or number.
template <class M>
concept PlacesQuantityIfAnything = PlacingSensor<M> || !requires {
  typename Placed<M>;
};
/// predict(), if it takes a point, returns an Eigen::Matrix<S, 2, 1>: no expression (auto).
template <class M>
concept PredictsPixelIfAnything = PredictingSensor<M> || !requires {
  typename Predicted<M>;
};
template <class M>
concept HasTypeName = requires {
  { M::kType } -> std::convertible_to<std::string_view>;
};

}  // namespace detail

/// A sensor.
template <class M>
concept Sensor = detail::HasTypeName<M> && detail::PlacesQuantityIfAnything<M> &&
    detail::PredictsPixelIfAnything<M> &&(PlacingSensor<M> || PredictingSensor<M>);

/// The quantity that place() delivers; nullopt if a sensor only predicts.
template <Sensor M>
[[nodiscard]] constexpr std::optional<Quantity> placed_quantity() {
  if constexpr (detail::PlacesOne<M, Quantity::point>) return Quantity::point;
  if constexpr (detail::PlacesOne<M, Quantity::ray>) return Quantity::ray;
  if constexpr (detail::PlacesOne<M, Quantity::pose>) return Quantity::pose;
  if constexpr (detail::PlacesOne<M, Quantity::reading>) return Quantity::reading;
  return std::nullopt;
}

/// True if a sensor can deliver the quantity a block takes.
template <Sensor M>
[[nodiscard]] constexpr bool delivers(Quantity quantity) {
  if (quantity == Quantity::pixel) return PredictingSensor<M>;
  return placed_quantity<M>() == (quantity == Quantity::plane ? Quantity::point : quantity);
}

}  // namespace kinecal
