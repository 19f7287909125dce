// Generates a C++ header from a URDF: the robot as constant data, a RobotData.
//
// The program kinecal_robot_header writes it; kinecal_add_robot() runs that program at build time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// The text of a header with the robot of a URDF, `<namespace>::Robot`.
/// @param path        of the URDF
/// @param name_space  such as `fetch` or `robots::fetch`; empty: the robot's name
/// @throws InputError  like read_urdf(), and if the namespace is invalid
[[nodiscard]] std::string robot_header(const std::string& path, const std::string& name_space = "");

}  // namespace kinecal
