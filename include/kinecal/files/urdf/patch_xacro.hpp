// A calibration written into the xacro file that a URDF was made of, where its numbers are literals.
//
// What changed is read from the two URDFs, before and after.  A number of the xacro file that equals the
// one before is replaced; one that is a property, a macro's parameter or an expression is named with
// its line and the number that it should become.  All other text stays, so patching again changes nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// A patched xacro file.
struct XacroPatch {
  std::string text;                  ///< of the file
  std::vector<std::string> patched;  ///< joints that were, or need not be any more
  std::vector<std::string>
      unpatched;  ///< "file:line: what is not a literal; what it should become"
};

/// Patches the origins, limits and calibrations of joints.
/// @param text               the xacro file, UTF-8; files that it includes are not read
/// @param name_for_messages  its name
/// @param original           the URDF that xacro made of it
/// @param calibrated         the same URDF as patch_urdf() returned it
/// @throws InputError  if a text is not XML, or its root is not <robot>
[[nodiscard]] XacroPatch patch_xacro(const std::string& text, const std::string& name_for_messages,
                                     const std::string& original, const std::string& calibrated);

}  // namespace kinecal
