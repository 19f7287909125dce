// Finds why samples fit badly: undoes what may be wrong (suspect.hpp), fits again and compares.
//
// Evidence of a suspect is the fit without it.  It explains the samples only if that reaches the noise: distances of
// a good result, a tenth of the cost, and no parameter that ends farther from where it began than robots are wrong.
// The cost is in units that no suspect shrinks: points that are multiplied by 0.5 leave half of the residuals, and that
// is no better fit.  Where none reaches the noise, suspects are combined: all signs, then what helps most with each of
// the others.
//
// Many free lengths can fit samples of a mistake: then an explanation is what fits as well with plausible values.
//
// Of those that fit as well as the best within the noise, those whose parameters move least remain; the simplest of
// them is named first, the others beside it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/explain/suspect.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust/assess.hpp"

namespace kinecal {

/// Solves a calibration: calibrate(), or one with other starts.
using Calibrator = std::function<CalibrationResult(const Calibration&)>;

/// What explains a bad fit.
struct Explained {
  /// What reaches the noise: "with the positions of 'elbow' and 'wrist' exchanged, the mean residual of 'hand_eye' falls
  /// from 93 mm to 0.11 mm"; what explains the same follows in the sentence.  Empty: nothing does.
  std::string cause;
  std::string helps;  ///< what helps most, if nothing reaches the noise and it halves the residuals
  int tried = 0;      ///< suspects and their combinations
  double left = 1.0;  ///< of the cost, with the cause undone
};

/// What is weighed.
struct ExplainOptions {
  std::span<const Suspect> own = {};  ///< suspects beside suspects_of()
  bool combines = true;               ///< tries combinations, too, where no suspect is enough
  Calibrator solve = {};              ///< solves each; must not throw.  Empty: calibrate()
};

/// Why samples fit badly, or cannot be fitted.  With many samples, only every n-th is used.
/// @param samples  as they were recorded
[[nodiscard]] Explained explain_fit(const Config& config, const Robot& robot,
                                    std::span<const Sample> samples,
                                    const ExplainOptions& options = {});

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
