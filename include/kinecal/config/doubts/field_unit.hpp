// Checks the unit of a magnetometer by the strength of the field that its readings show.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

/// Error: readings in another unit than microtesla, with the unit that the earth's field suggests, 22 to 67 microtesla.  Doubt: a
/// field that is not the earth's.
/// @param field     strength of the field that the readings show, microtesla if their unit is right
/// @param in_plane  they show what is in the plane of a turn only: less, near the poles little
/// @param place     of the error block
void check_field_unit(double field, bool in_plane, const SourceLocation& place,
                      Diagnostics& diagnostics);

}  // namespace kinecal::detail
