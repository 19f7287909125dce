// The tables of a study: summaries of the trials of one robot with one number of poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "kinecal/study/repeatability.hpp"
#include "kinecal/study/sample_design.hpp"

namespace kinecal {

/// A parameter over the trials of a group.
struct ParameterSpread {
  double truth = 0.0;     ///< of the robot, in the unit of the parameter
  double mean = 0.0;      ///< of the trials
  double variance = 0.0;  ///< of the trials, divided by their number less one
  /// According to the covariance; infinite if the samples do not determine the parameter.
  double predicted = 0.0;
};

/// Several calibrations of one robot with one number of poses.
struct StudyGroup {
  int robot = 0;     ///< from 0
  int poses = 0;     ///< samples of a calibration
  int trials = 0;    ///< calibrations
  int failed = 0;    ///< did not converge, or mean re-projection error beyond the limit
  int ruined = 0;    ///< samples of all trials
  int left_out = 0;  ///< samples of all trials
  std::vector<ParameterSpread> parameters;  ///< free ones
  double position = 0.0;                    ///< error of the pose, RMS of all trials, metres
  double varied_position = 0.0;             ///< scatter of the position between trials, metres
  double predicted_position = 0.0;          ///< the same according to the covariance, metres
  /// The same with Targets::free, metres; NaN: not requested.
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

/// Fills in the covariance's prediction for a group, and the scatter of the pose.
/// @param trials  of the group
void predict(const StudySetup& setup, const StudyRobot& robot, std::span<const StudyTrial> trials,
             StudyGroup& group);

/// Mean variance of the pose according to the covariance of some trials: trace(goal C), square
/// metres.
/// @param group  of these trials
/// @param goal   see position_goal()
[[nodiscard]] double varied_variance(const StudyGroup& group, std::span<const StudyTrial> trials,
                                     const PlainMatrix& goal);

}  // namespace kinecal
