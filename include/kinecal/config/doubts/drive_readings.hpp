// Checks the readings of a mobile base: wheels, odometry or a gyroscope that do not change while the base moves, and times that
// are not seconds or do not grow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Errors: readings that a block of a base takes and that are the same in all samples, while what is seen moves; times that are
/// constant, go backwards within a run, or by which the base would crawl: milliseconds.
/// @param samples  with what the sample before had: set_before()
void check_drive_readings(const Config& config, std::span<const Sample> samples,
                          Diagnostics& diagnostics);

}  // namespace kinecal::detail
