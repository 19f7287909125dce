// Files of points, PLY and PCD, as tables: a column for each property, a row for each point.
//
// Of PLY, the element vertex is read (ascii, binary of either byte order); of PCD, ascii and binary.  Fields of several numbers are
// left out; a vertex with lists is refused.
// Source: G. Turk, The PLY polygon file format, 1994; documentation of the Point Cloud Library, "The PCD file format".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kinecal::detail {

/// The text of a table, separated by commas, its first row the names; nullopt for any other file.
/// @param content  of the file, byte for byte
/// @param file     its name in messages
/// @throws InputError  if it is damaged, or compressed
[[nodiscard]] std::optional<std::string> point_file_table(std::string_view content,
                                                          const std::string& file);

}  // namespace kinecal::detail
