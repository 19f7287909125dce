// Strings and numbers of a scene's JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/linkage.hpp"

namespace kinecal::detail {

/// A string as JSON that may stand in HTML: <, >, & and line separators are escaped, and bytes that are
/// not UTF-8 become U+FFFD.
[[nodiscard]] std::string html_json_string(std::string_view text);

/// A number with some digits behind the point, without zeros at its end; "0" if it is not finite.
[[nodiscard]] std::string short_number(double value, int digits);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/scene_text.ipp"
#endif
