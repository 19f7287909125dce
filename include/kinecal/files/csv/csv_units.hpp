// Units as the columns of tables have them: "deg", "[mm]", "(rad)".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kinecal::detail {

/// The unit of a column.
enum class NamedUnit : std::uint8_t {
  none,
  radians,
  degrees,
  metres,
  millimetres,
  unreadable,  ///< of a length or an angle, but none that columns.yaml has: cm, mrad
  other        ///< of something else: s, N, px
};

/// The unit that a word names, small letters: "deg", "mm"; nullopt for any other word.
[[nodiscard]] std::optional<NamedUnit> named_unit(std::string_view word);

/// The unit of a cell in a row of units: "[deg]", "(mm)", "deg/s", "-"; nullopt if it is none.
[[nodiscard]] std::optional<NamedUnit> unit_of_cell(std::string_view cell);

/// True for a row of units below a header: every cell is one or empty, and one is of a length or an angle.
[[nodiscard]] bool are_units(const std::vector<std::string>& cells);

}  // namespace kinecal::detail
