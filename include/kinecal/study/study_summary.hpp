// The tables of a study: what the trials of one robot with one number of poses have in common.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/study/repeatability.hpp"
#include "kinecal/study/sample_design.hpp"

namespace kinecal {

/// A parameter over the trials of a group.
struct ParameterSpread {
  double truth = 0.0;     ///< of the robot, in the unit of the parameter
  double mean = 0.0;      ///< of the trials
  double variance = 0.0;  ///< of the trials, by their number less one
  /// By the covariance; infinite where the samples do not determine the parameter.
  double predicted = 0.0;
};

/// Several calibrations of one robot with one number of poses.
struct StudyGroup {
  int robot = 0;   ///< from 0
  int poses = 0;   ///< samples of a calibration
  int trials = 0;  ///< calibrations
  int failed = 0;  ///< that did not converge, or whose mean re-projection error is beyond the limit
  int ruined = 0;  ///< samples of all trials
  int left_out = 0;                         ///< samples of all trials
  std::vector<ParameterSpread> parameters;  ///< free ones
  double position = 0.0;                    ///< error of the pose, RMS of all trials, metres
  double varied_position = 0.0;             ///< how much the position varies between trials, metres
  double predicted_position = 0.0;          ///< the same by the covariance, metres
  /// The same with Targets::free, metres; not a number: not asked for.
  double free_targets = std::numeric_limits<double>::quiet_NaN();
  double worst_position = 0.0;  ///< of a trial, metres
  double rotation = 0.0;        ///< RMS, radians
  double reprojection = 0.0;    ///< mean, unit of the error block
  double systematic = 0.0;      ///< mean of samples without noise
  double nonlinearity = 0.0;    ///< mean: see StudyTrial
};

/// Summarizes trials, group by group.
/// @param robots   those of the trials, by number
/// @param trials   in the order of their jobs
/// @param limit    of the mean re-projection error; the paper's: 3 mm
[[nodiscard]] std::vector<StudyGroup> summarize(const StudySetup& setup,
                                                std::span<const StudyRobot> robots,
                                                std::span<const StudyTrial> trials, double limit);

/// Fills in what the covariance predicts for a group, and how much the pose varied.
/// @param trials  of the group
void predict(const StudySetup& setup, const StudyRobot& robot, std::span<const StudyTrial> trials,
             StudyGroup& group);

/// Mean variance of the pose by the covariance of some trials: trace(goal C), square metres.
/// @param group  theirs
/// @param goal   see position_goal()
[[nodiscard]] double varied_variance(const StudyGroup& group, std::span<const StudyTrial> trials,
                                     const PlainMatrix& goal);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/study/study_summary.ipp"
#endif
