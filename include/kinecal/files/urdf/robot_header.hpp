// The robot of a URDF as a C++ header: constant data, which is a RobotData.
//
// The program kinecal_robot_header writes it; kinecal_add_robot() runs that program when a project
// is built.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// The text of a header with the robot that a URDF describes, `<namespace>::Robot`.
/// @param path        of the URDF
/// @param name_space  such as `fetch` or `robots::fetch`; empty: the robot's name
/// @throws InputError  as read_urdf(), and if the namespace cannot be one
[[nodiscard]] std::string robot_header(const std::string& path, const std::string& name_space = "");

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/urdf/robot_header.ipp"
#endif
