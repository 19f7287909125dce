// The sensors that the library has compiled.  A new one for everyone is its header, its name here and in
// evaluation/built_in_sensors.hpp; a lens has its name in lenses.hpp instead.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include "kinecal/linkage.hpp"
#include "kinecal/sensors/any_sensor.hpp"
#include "kinecal/sensors/bent_board.hpp"
#include "kinecal/sensors/chain_point.hpp"
#include "kinecal/sensors/depth/depth_camera.hpp"
#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal {

namespace detail {
template <class Lenses>
struct SensorsWith;
template <class... Ls>
struct SensorsWith<LensList<Ls...>> {
  using type = std::variant<ChainPoint, DepthCamera, LensCamera<Ls>..., BentBoard, ChainPose>;
};
}  // namespace detail

/// A sensor of a built-in type; configurations name it by its kType.
using BuiltInSensor = detail::SensorsWith<Lenses>::type;

/// A camera by the name of its lens: lens_of() or lens_named().
/// @throws std::invalid_argument  if there is no such lens
[[nodiscard]] BuiltInSensor lens_camera(std::string_view lens,
                                        ImageKind image = ImageKind::automatic);

/// A built-in sensor behind the common interface.
[[nodiscard]] std::shared_ptr<const AnySensor> any_built_in(const BuiltInSensor& sensor);

namespace detail {
/// True for a type of a variant.
template <class T, class Variant>
inline constexpr bool kIsOneOf = false;
template <class T, class... Ts>
inline constexpr bool kIsOneOf<T, std::variant<Ts...>> = (std::is_same_v<T, Ts> || ...);

/// Any sensor behind the common interface: built-in types are compiled in the library.
template <Sensor M>
[[nodiscard]] std::shared_ptr<const AnySensor> behind_interface(const M& sensor) {
  if constexpr (kIsOneOf<M, BuiltInSensor>) return any_built_in(sensor);
  return any_sensor(sensor);
}
}  // namespace detail

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/sensors/built_in_sensor.ipp"
#endif
