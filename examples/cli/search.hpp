// A search for what is free, in words: of identify, and of calibrate where a configuration leaves it open.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/procedure/calibrate_robot.hpp"

namespace kinecal::cli {

/// "Robot 'ur5e', 60 samples: 54 parameters may be wrong, 3 of them these samples support", and the table of steps.
/// @param calibrated  after a search
[[nodiscard]] std::string search_summary(const CalibratedRobot& calibrated);

/// The configuration that frees what a search found, as YAML with comments; empty: there was none.
[[nodiscard]] std::string found_config(const CalibratedRobot& calibrated);

/// True if a search freed nothing: there is no result.
[[nodiscard]] bool found_nothing(const CalibratedRobot& calibrated);

}  // namespace kinecal::cli
