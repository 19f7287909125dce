// Velocity limits of the joints of a URDF.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Velocity limits by joint, rad/s or m/s.  Skips joints without a positive one.
/// @param text               the URDF, UTF-8
/// @param name_for_messages  name of the text in messages: its file
/// @throws InputError  "file:line: message" if the text is not a URDF, or a limit is not a number
[[nodiscard]] std::map<std::string, double> velocity_limits(const std::string& text,
                                                            const std::string& name_for_messages);

}  // namespace kinecal
