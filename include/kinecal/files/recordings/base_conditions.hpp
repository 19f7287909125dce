// What joints of a mobile base and columns of a table hold of its drive, by their names: conditions of samples, as the error
// blocks of errors/base_motion.hpp take them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace kinecal {

/// Conditions that are positions of joints: of the wheels of a differential drive, of mecanum wheels, of a tricycle.
inline constexpr std::array<std::string_view, 8> kWheelConditions = {
    "left_wheel",       "right_wheel", "front_left_wheel", "front_right_wheel", "rear_left_wheel",
    "rear_right_wheel", "wheel",       "steering"};

/// The condition with this name: "l_wheel_joint" and "enc_left" are left_wheel, "odom.theta" is odom_yaw, "x" is track_x;
/// empty if the name says none.  A caster is none.
[[nodiscard]] std::string base_condition(std::string_view name);

/// The same of a joint: a wheel or a steering angle.
[[nodiscard]] std::string wheel_condition(std::string_view joint);

}  // namespace kinecal
