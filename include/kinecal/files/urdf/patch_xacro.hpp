// A calibration written into the xacro files that a URDF was made of, where its numbers are literals.
//
// What changed is read from the two URDFs, before and after.  A number of a xacro file that equals the
// one before is replaced; one that is a property, a macro's parameter or an expression is named with
// its line and the number that it should become.  All other text stays, so patching again changes nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/urdf/xacro_files.hpp"

namespace kinecal {

/// A patched xacro file.
struct PatchedXacro {
  std::string name;                  ///< of the file
  std::string text;                  ///< of the file
  std::vector<std::string> patched;  ///< joints that were, or need not be any more
};

/// Patched xacro files.
struct XacroPatch {
  std::vector<PatchedXacro> files;  ///< all that were given, in their order
  std::vector<std::string>
      unpatched;  ///< "file:line: what is not a literal; what it should become"
};

/// Patches the origins, limits and calibrations of joints.
/// @param files       the xacro file, and those that it includes: read_xacro_files()
/// @param original    the URDF that xacro made of them
/// @param calibrated  the same URDF as patch_urdf() returned it
/// @throws InputError  if a text is not XML, or its root is not <robot>
[[nodiscard]] XacroPatch patch_xacro(const std::vector<XacroFile>& files,
                                     const std::string& original, const std::string& calibrated);

}  // namespace kinecal
