// A table of poses: one file, or a folder with a text file of numbers for each image.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// True if the poses are in a folder, a text file for each.
[[nodiscard]] bool is_pose_folder(const std::string& path);

/// The text of a table.  Of a folder, its text files become the rows of one, in natural order: the
/// name without ending as `image`, then their numbers as columns 1, 2, ...; a matrix may have several
/// lines.  These are the .txt files, or those of the ending that most others have, images aside.  Poses of
/// UR, p[0.1, -0.4, 0.3, 0, 3.1, 0], become cells x, y, z, rx, ry, rz.
/// @throws InputError  if a file cannot be read, or the files have different numbers of numbers
[[nodiscard]] std::string read_pose_table(const std::string& path);

}  // namespace kinecal
