// Why a calibration fits badly: simple mistakes are undone one at a time, and it is solved again.
//
// A mistake that explains the residuals makes them fall by much when it is undone.  It costs one
// solve for each: two joints' names exchanged, one joint's sign, degrees, units of each sensor, models
// exchanged, features in reverse order; some more for the scale of each sensor's points.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

/// Solves a calibration: calibrate(), or one with other starts.
using Calibrator = std::function<CalibrationResult(const Calibration&)>;

/// Sentences about mistakes that explain a bad fit, the best first: "with the positions of 'elbow'
/// and 'wrist' exchanged, the mean residual of 'hand_eye' falls from 93 mm to 0.11 mm".  Empty if no
/// mistake brings the cost below a tenth.
///
/// With many samples, every n-th is used, for these solves as well as for the one to compare with.
/// @param samples  with positions in the convention of the calibration that fits badly
/// @param solve    with what each is solved, also the samples as they are; must not throw
[[nodiscard]] std::vector<std::string> likely_causes(const Config& config, const Robot& robot,
                                                     std::span<const Sample> samples,
                                                     const Calibrator& solve = {});

/// Sentences about models whose points, with another scale, make the noise of a fit that is not bad fall
/// to a half: a board whose squares are larger than was said.  Empty for most calibrations.
/// @param samples   those that were fitted
/// @param solution  the parameters that fit them; where it begins
[[nodiscard]] std::vector<std::string> wrong_scales(const Config& config, const Robot& robot,
                                                    std::span<const Sample> samples,
                                                    const ParameterTable& solution);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/config/doubts/likely_causes.ipp"
#endif
