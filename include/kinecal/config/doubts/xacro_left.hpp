// A URDF in which xacro left something: with parts missing, or with remnants that ROS ignores as well.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal::detail {

/// Error: links, joints or numbers of joints may be missing, with the command that expands the file.
/// Warning: remnants on which no link or joint depends, by name and line.
/// @param text               the URDF, as parse_urdf() took it
/// @param name_for_messages  its file
void check_xacro(const std::string& text, const std::string& name_for_messages,
                 Diagnostics& diagnostics);

/// The command that expands a file of xacro into another one, which is never the file itself.
/// @param file  its name; without an ending it is not a file, and there is no command: empty
[[nodiscard]] std::string xacro_command(const std::string& file);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/config/doubts/xacro_left.ipp"
#endif
