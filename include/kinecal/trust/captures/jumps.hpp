// Jumps of readings: samples that are so far off where a fit begins that it may find no way.
//
// A fit without a loss follows an odometry that began again at zero, or a reading with a wrong bit, and does not arrive, or
// arrives at its bounds.  Where errors of a base are by intervals, and readings of a magnetometer by themselves, these are single samples: those whose residual
// is ten times as large as that of nine samples in ten.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

/// The samples of the last step that jump where the calibration begins, and why; empty if they are more than one in fifty, or if
/// residuals are undefined there.  Only error blocks of a base and of a magnetometer are looked at.
[[nodiscard]] std::map<int, std::string> jumps_at_start(const Calibration& calibration);

}  // namespace kinecal
