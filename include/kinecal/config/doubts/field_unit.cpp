// Definitions of field_unit.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/field_unit.hpp"

#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>

namespace kinecal::detail {

namespace {

/// What readings of this size are in; "counts" if no unit makes them the earth's field.
[[nodiscard]] std::string unit_of_field(double field, double least, double most) {
  constexpr std::array<std::pair<double, const char*>, 7> kUnits = {
      {{1e6, "tesla"},
       {1e3, "millitesla"},
       {1e2, "gauss"},
       {0.1, "milligauss, or counts of the sensor"},
       {1e-3, "nanotesla"},
       {1e-4, "gauss, from a driver that publishes them as tesla"},
       {1e-6, "microtesla, from a driver that publishes them as tesla"}}};
  for (const auto& [factor, name] : kUnits) {
    const double in_microtesla = factor * field;
    if (in_microtesla < least || in_microtesla > most) continue;
    return fmt::format("are the readings {}?  Multiply them by {:g}", name, factor);
  }
  return "are the readings counts of the sensor?  Convert them to microtesla";
}

}  // namespace

void check_field_unit(double field, bool in_plane, const SourceLocation& place,
                      Diagnostics& diagnostics) {
  constexpr double kLeast = 22.0, kMost = 67.0;  // microtesla, of the earth (World Magnetic Model)
  constexpr double kLeastInPlane = 5.0;          // but near the poles
  constexpr double kFar = 2.2;  // times less or more, which iron beside the sensor may do
  const double least = in_plane ? kLeastInPlane : kLeast;
  if (field >= least && field <= kMost) return;
  const std::string found = fmt::format(
      "the readings of the magnetometer show a field of {:.3g} microtesla{}, the "
      "earth's is {:g} to {:g}",
      field, in_plane ? " in the plane of the turn" : "", in_plane ? 0.0 : kLeast,
      in_plane ? 42.0 : kMost);
  if (field * kFar < least || field > kFar * kMost) {
    diagnostics.error(place, found + ": " + unit_of_field(field, least, kMost));
  } else if (!in_plane || field > kMost) {
    diagnostics.doubt(place, found +
                                 "; is the unit right, is iron or a magnet near that does not "
                                 "turn with the sensor?");
  }
}

}  // namespace kinecal::detail
