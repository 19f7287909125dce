// A floating joint: it moves freely, and each sample has its measured pose, such as that of a flange
// as the robot's controller reports it.
//
//   parent_T_child = origin * measured * correction
//
// A chain takes it as six joints in a row, its coordinates: three that slide along x, y, z, then three
// that turn about z, y, x.  So walks and twists know no other kinds of joints.  Coordinates have no
// offsets, and no message names them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/geometry/rpy.hpp"

namespace kinecal {

/// The coordinates of a floating joint, from parent to child.
inline constexpr std::array<std::string_view, 6> kFloatingCoordinates = {"x",   "y",     "z",
                                                                         "yaw", "pitch", "roll"};

/// The name of a coordinate: "yaw of flange".
[[nodiscard]] inline std::string floating_coordinate(const std::string& joint, std::size_t i) {
  return std::string(kFloatingCoordinates[i]) + " of " + joint;
}

/// A coordinate, by its name.
struct FloatingCoordinate {
  std::string joint;      ///< the floating joint
  std::size_t index = 0;  ///< in kFloatingCoordinates
};

/// The coordinate that a name means, if it has the form of one.
[[nodiscard]] inline std::optional<FloatingCoordinate> floating_coordinate(
    const std::string& name) {
  const std::size_t end = name.find(" of ");
  if (end == std::string::npos) return std::nullopt;
  for (std::size_t i = 0; i < kFloatingCoordinates.size(); ++i) {
    if (std::string_view(name).substr(0, end) == kFloatingCoordinates[i]) {
      return FloatingCoordinate{name.substr(end + 4), i};
    }
  }
  return std::nullopt;
}

/// The coordinates of a pose: parent_T_child = T(x, y, z) Rz(yaw) Ry(pitch) Rx(roll).
/// @returns  (6) metres and radians, in the order of kFloatingCoordinates
[[nodiscard]] inline std::array<double, 6> floating_positions(const Pose<double>& parent_T_child) {
  const Vector3<double>& t = parent_T_child.translation;
  const Vector3<double> rpy = rpy_from_rotation(parent_T_child.rotation);
  return {t.x(), t.y(), t.z(), rpy.z(), rpy.y(), rpy.x()};
}

/// The pose with these coordinates.
/// @param at  (6) metres and radians, in the order of kFloatingCoordinates
[[nodiscard]] inline Pose<double> floating_pose(const std::array<double, 6>& at) {
  return {rotation_from_rpy({at[5], at[4], at[3]}), {at[0], at[1], at[2]}};
}

}  // namespace kinecal
