// Reads a robot from its URDF, with urdfdom.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// The robot described by a URDF, with its joints in text order.
/// @param text               the URDF, UTF-8
/// @param name_for_messages  name of the text in messages: its file
/// @throws InputError  "file:line: message" if the text is not a URDF or its joints are not a tree
[[nodiscard]] Robot parse_urdf(const std::string& text, const std::string& name_for_messages);

/// The text of a URDF, byte for byte; of a URDF in a value of YAML or behind other words, as `ros2 param get` and `ros2 topic
/// echo` print it, only that.
/// @throws InputError  if it cannot be read
[[nodiscard]] std::string read_urdf_text(const std::string& path);

/// The robot described by a URDF file.
/// @throws InputError  if the file cannot be read, and like parse_urdf()
[[nodiscard]] Robot read_urdf(const std::string& path);

}  // namespace kinecal
