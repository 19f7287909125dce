// Checks calibrated joint offsets against the limits of the URDF.
//
// An offset is an angle: -6.2 rad is 0.08 rad.  A joint cannot be off by more than its travel, and
// with its offset it must have been within its limits: q + offset, for every recorded q.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/config/doubts/find_doubts.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/parameters/parameter_table.hpp"

namespace kinecal {

/// Error: an offset is larger than the joint's travel; or moves recorded positions more than 20
/// degrees (10 cm) beyond its limits, further than they were before; or is half a turn from its
/// initial value:  the mirror image of a robot fits as well as the robot.  Doubt: it is more than
/// 20 degrees, or 10 cm, from its initial value.
/// @param input       what was calibrated; source locations refer to the URDF's limits
/// @param calibrated  the table after the calibration
void check_offsets(const CalibrationInput& input, const ParameterTable& calibrated,
                   Diagnostics& diagnostics);

}  // namespace kinecal
