// Makes texts from files safe for a terminal: control characters could move the cursor, change
// colours or hide a message.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/linkage.hpp"

namespace kinecal {

/// True if a text has line ends or control characters other than tabs, or is not UTF-8.
[[nodiscard]] bool has_control_characters(std::string_view text);

/// The text with control characters of ASCII, and bytes that are not UTF-8, as "\x1b", and with others that
/// must not be shown, such as those that change the direction of writing, as "\u202e".  Keeps line ends and
/// tabs.  JSON stays the same JSON.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/text/printable.ipp"
#endif
