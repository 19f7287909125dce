// What would make a calibration better: parameters that are held, and what freeing them buys.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust/judge.hpp"

namespace kinecal {

/// What would help a calibration.
struct WouldHelp {
  std::vector<std::string> sentences;  ///< see would_help()
  std::string
      camera;  ///< prefix of the camera whose intrinsics they name, if they name nothing else
  double first_left = 1.0;  ///< of the error on held-out poses with the first of them
  double left = 1.0;        ///< the same with all of them
};

/// Sentences, at most two: "freeing elbow_joint_x lowers the error on held-out poses from 0.56 mm to 0.31 mm", "and with
/// it ...".  Each is tested by another solve, of at most 2000 samples.  Empty if nothing lowers it by a tenth, for several
/// steps, and for samples of one pose.
/// @param config       of the calibration
/// @param samples      that were used
/// @param calibration  whose free parameters stay free
/// @param result       of it
[[nodiscard]] WouldHelp would_help(const Config& config, const Robot& robot,
                                   std::span<const Sample> samples, const Calibration& calibration,
                                   const CalibrationResult& result);

/// Adds to a verdict that the lens of a camera is at fault, if its intrinsics alone lower the error on held-out poses by
/// 30 percent or more; that what is held is wrong, if freeing one other parameter does so by 25 percent and by that more
/// than what is named already, and if residuals are larger than what robots are good to.
/// @param step  the assessment of the last step
void judge_help(const WouldHelp& help, const Assessment& step, Judgement& judgement);

}  // namespace kinecal
