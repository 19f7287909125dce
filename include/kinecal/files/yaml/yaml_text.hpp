// Numbers and names as YAML text that reads back as the same value.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace kinecal {

/// The value of a number: decimal, nan, inf, .nan or .inf, each with or without a sign.
/// @return  nullopt if the whole text is not such a number or does not fit into a double
[[nodiscard]] std::optional<double> number_from_yaml(std::string_view text);

/// Shortest text that number_from_yaml() reads as the same double (any NaN as .nan).  It has a
/// decimal point (1.0, 1.0e-05); without it some YAML readers take it for an integer or a string.
[[nodiscard]] std::string number_to_yaml(double value);

namespace detail {

/// "[1.0, 2.0]"
[[nodiscard]] std::string numbers_to_yaml(std::span<const double> numbers);

/// The text of a finite decimal number times 10^by, without rounding: "1.5" by -3 is "1.5e-3".
[[nodiscard]] std::string times_power_of_ten(std::string_view number, int by);

/// Metres from a text in millimetres.  Moves the decimal point instead of dividing, which would
/// round.
/// @return  nullopt if the text is not a number
[[nodiscard]] std::optional<double> metres_from_millimetres(std::string_view text);

/// Text in millimetres that metres_from_millimetres() reads as the same double.
/// @param metres  metres, below 1e305
[[nodiscard]] std::string millimetres_from_metres(double metres);

/// A name (UTF-8): plain if every YAML reader takes it for this string, else in double quotes with
/// escapes.
[[nodiscard]] std::string name_to_yaml(std::string_view name);

}  // namespace detail

}  // namespace kinecal
