// Finds why a calibration fits badly: undoes simple mistakes one at a time and solves again.
//
// Undoing the right mistake lowers the residuals considerably.  Each takes one solve: two joints'
// names exchanged, one joint's sign, degrees, units of each sensor, models exchanged, features in
// reverse order.  The scale of each sensor's points takes a few more.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust/assess.hpp"

namespace kinecal {

/// Solves a calibration: calibrate(), or one with other starts.
using Calibrator = std::function<CalibrationResult(const Calibration&)>;

/// Sentences about mistakes that explain a bad fit, best first: "with the positions of 'elbow' and
/// 'wrist' exchanged, the mean residual of 'hand_eye' falls from 93 mm to 0.11 mm".  Empty if none
/// brings the cost below a tenth.  Where the samples as they are cannot be solved, a mistake counts only if
/// without it they fit about as well as the best of them, and well enough for a result that may be used.
///
/// With many samples, only every n-th is used, also for the solve to compare with.
/// @param samples  with positions in the convention of the calibration that fits badly
/// @param solve    solves each hypothesis, and the samples as they are; must not throw
[[nodiscard]] std::vector<std::string> likely_causes(const Config& config, const Robot& robot,
                                                     std::span<const Sample> samples,
                                                     const Calibrator& solve = {});

/// Sentences about models whose points have another scale, in a fit that is not bad: a board with larger
/// squares than configured.  At the right scale the noise is half as large; or free lengths, which have
/// absorbed the scale, all change by less; or the noise is half as large where zeros are free in place of lengths
/// and joint models.
/// Empty for most calibrations.
/// @param samples   the fitted samples
/// @param solution  the parameters that fit them; the start
/// @param last      the assessment of the last step
[[nodiscard]] std::vector<std::string> wrong_scales(const Config& config, const Robot& robot,
                                                    std::span<const Sample> samples,
                                                    const ParameterTable& solution,
                                                    const Assessment& last);

}  // namespace kinecal
