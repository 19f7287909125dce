// Judges a result by its files: what a program finds that reads them.
//
// For a driver that applies calibration.yaml errors are those of the fit.  The URDF alone may leave more: it holds no joint
// models.  If that matters, the result is to be used with care, or not at all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/procedure/calibrate_robot.hpp"

namespace kinecal {

/// Sets CalibratedRobot::read_back, and judges it.  Does nothing without the text of the URDF, if it cannot hold the
/// result, or where a target has a pose of its own in each sample.
void judge_read_back(CalibratedRobot& calibrated, const CalibrationOptions& options);

}  // namespace kinecal
