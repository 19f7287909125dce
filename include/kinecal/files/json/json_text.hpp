// JSON as text: compact, by lines for people, or for a page.  By nlohmann-json, whose trees keep the order
// of their fields.  Numbers have the fewest digits that read back the same; one that is not finite is null.
// Bytes of strings that are not UTF-8 become U+FFFD.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace kinecal::detail {

using Json = nlohmann::ordered_json;

/// Without blanks, in one line.
[[nodiscard]] std::string json_text(const Json& json);

/// The same for a <script> in HTML: it has no <, > and &, and is ASCII.
[[nodiscard]] std::string json_in_html(const Json& json);

/// A line for each field and for each of its items, and a line for what is further inside, unless it holds
/// lists or objects itself: nlohmann-json has only all in one line, or a line for each number.
[[nodiscard]] std::string json_lines(const Json& json);

/// A number with some digits behind the point; 0 if it is not finite.
[[nodiscard]] Json rounded(double value, int digits);

}  // namespace kinecal::detail
