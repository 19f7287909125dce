// Texts and numbers in charts: safe in XML, short, and the same on every machine.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace kinecal::detail {

/// A text between tags or in an attribute of XML.  Bytes that are not UTF-8, control characters and
/// those that change the direction of writing become U+FFFD.
[[nodiscard]] std::string svg_escaped(std::string_view text);

/// A name of at most `most` characters, shortened in the middle: "left_shou…r_pan_joint".
/// Right-to-left text is isolated, so that figures beside it keep their places.  Not escaped.
[[nodiscard]] std::string shortened(std::string_view name, std::size_t most);

/// A name for use in file names and ids: lower case, digits, '_' and '-'.
[[nodiscard]] std::string slug_of(std::string_view name);

/// Width of a text in a common sans serif font, in units of the font size.  An estimate.
[[nodiscard]] double text_width(std::string_view text);

/// Appends a coordinate with one decimal; 0 if it is not finite.
void append_coordinate(std::string& text, double value);
/// The same as a text.
[[nodiscard]] std::string coordinate(double value);

/// A readable figure: three digits, "0.0123", "12.3", "12 345", "1.2e-7"; "–" if it is not finite.
[[nodiscard]] std::string figure(double value, int digits = 3);

/// A count: "200 000".
[[nodiscard]] std::string count_text(std::size_t number);

}  // namespace kinecal::detail
