// Remnants of xacro in a URDF: missing parts, or remnants that ROS ignores as well.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// Error: links, joints or numbers of joints may be missing, with the command that expands the
/// file.  Warning: remnants that no link or joint depends on, by name and line.
/// @param text               the URDF, as parse_urdf() took it
/// @param name_for_messages  its file
void check_xacro(const std::string& text, const std::string& name_for_messages,
                 Diagnostics& diagnostics);

/// The command that expands a xacro file into a file that does not exist yet.
/// @param file  its name; empty result if it has no extension, because then it is not a file
[[nodiscard]] std::string xacro_command(const std::string& file);

}  // namespace kinecal::detail
