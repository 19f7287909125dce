// A xacro file with the files that it includes.
//
//   <xacro:include filename="arm.xacro"/>                     beside the file that includes it
//   <xacro:include filename="$(dirname)/arm.xacro"/>          the same
//   <xacro:include filename="$(find arm_description)/a.xacro"/>   in a parent folder that is this package,
//                                                             by its name or its package.xml
//
// Source: ROS wiki, xacro.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// A xacro file.
struct XacroFile {
  std::string name;  ///< by which it was found
  std::string text;  ///< UTF-8
};

/// Reads a xacro file and all that it includes, each once; the first is the file itself.
/// @param diagnostics  receives a warning for each include that cannot be read: its name is an expression,
///                     or there is no such file
/// @throws InputError  if the file itself cannot be read, or is not XML with the root <robot>
[[nodiscard]] std::vector<XacroFile> read_xacro_files(const std::string& file,
                                                      Diagnostics& diagnostics);

}  // namespace kinecal
