// Finds what looks wrong in the input of a calibration, before anything is solved.
//
// Errors cannot be right; doubts could be.  Each finding is reported once, with its first source
// location and the likely cause.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "kinecal/config/config.hpp"
#include "kinecal/config/doubts/rising.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

/// The input of a calibration, read and assembled.
struct CalibrationInput {
  const Config& config;          ///< from read_config()
  const Robot& robot;            ///< from parse_urdf()
  const std::string& urdf_text;  ///< the text of the URDF; empty: a robot without one
  const std::string& urdf;       ///< its name in messages: its file
  std::span<const Sample>
      samples;  ///< may be empty: then the robot and the configuration are checked
  const Calibration& calibration;       ///< from assemble()
  Recorded recorded = Recorded::after;  ///< when the samples were recorded
  bool is_part = false;                 ///< there are more samples elsewhere: these may be few
};

/// Adds findings to the errors, doubts and warnings.  Checks the URDF first, then joint positions,
/// then points: a wrong unit in one makes the next look wrong, too, so that is not reported.  If
/// there are already errors, checks only the URDF and initial values.
void find_doubts(const CalibrationInput& input, Diagnostics& diagnostics);

}  // namespace kinecal
