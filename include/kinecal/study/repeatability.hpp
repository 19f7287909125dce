// Repeatability of calibrations: simulated robots are each calibrated several times with several
// numbers of poses.  Compares the variance of each parameter with the covariance's prediction.
//
// A study is a list of jobs.  Each job has its own random numbers, so jobs may run in any order, on
// any number of threads and machines, with the same tables as result.
// Source: the Fetch paper, IV: variance over ten calibrations with 100, 50 and 25 poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "kinecal/study/error_sizes.hpp"
#include "kinecal/study/exact_samples.hpp"
#include "kinecal/study/measurement_noise.hpp"
#include "kinecal/trust/uncertainty/pose_uncertainty.hpp"

namespace kinecal {

/// The result of calibrating simulated samples.
struct StudyFit {
  bool converged = false;
  std::vector<double> values;  ///< of all parameters of the table
  int left_out = 0;            ///< samples that did not fit
  double seconds = 0.0;        ///< of all its solves
  int solves = 1;              ///< more than one if samples were left out
};

/// The setup of a study.
struct StudySetup {
  MakeProblem make;             ///< the last step without samples
  std::vector<int> free;        ///< table indices of its free parameters
  std::vector<double> drawn;    ///< values of all parameters of a robot without errors
  std::vector<Sample> samples;  ///< poses and targets: see exact_samples()
  FrameOnRobot frame, in;       ///< whose pose is judged, and in which frame
  MeasurementNoise noise = {};
  ErrorSizes errors = {};
  double ruined = 0.0;        ///< share of samples with a joint elsewhere than reported
  double ruined_by = 0.05;    ///< radians or metres
  std::uint64_t seed = 1;     ///< same seed: same robots and noise
  bool free_targets = false;  ///< also predict with six unknowns per target
  std::function<StudyFit(std::span<const Sample>)> fit;  ///< calibrates, as a user would
};

/// A simulated robot.
struct StudyRobot {
  int number = 0;               ///< from 0
  std::vector<double> truth;    ///< of all parameters of the table
  std::vector<Sample> samples;  ///< that it would measure without noise
};

/// The true values of all parameters of a robot.
[[nodiscard]] std::vector<double> study_truth(const StudySetup& setup, int number);

/// A robot, with the samples that it would measure.
/// @throws StudyError  if it cannot measure a sample
[[nodiscard]] StudyRobot study_robot(const StudySetup& setup, int number);

/// One calibration of one robot.
struct StudyJob {
  int robot = 0;   ///< from 0
  int poses = 0;   ///< number of samples
  int repeat = 0;  ///< from 0

  /// By robot, then by poses, the most first, then by repetition.
  friend bool operator<(const StudyJob& a, const StudyJob& b) {
    if (a.robot != b.robot) return a.robot < b.robot;
    return a.poses != b.poses ? a.poses > b.poses : a.repeat < b.repeat;
  }
};

/// The result of a job.
struct StudyTrial {
  StudyJob job = {};
  bool converged = false;
  int ruined = 0;             ///< samples that were ruined
  int left_out = 0;           ///< samples that the calibration left out
  double position = 0.0;      ///< error of the judged pose, over all poses, RMS, metres
  double rotation = 0.0;      ///< the same, radians
  double reprojection = 0.0;  ///< mean distance of features of new samples, in the block's unit
  double systematic = 0.0;    ///< the same for samples without noise
  /// Distance of the residuals from those of the linearized problem, relative to their change by
  /// its solution: below 0.1, variances match the covariance.
  double nonlinearity = 0.0;
  double seconds = 0.0;             ///< of the calibration's solves
  int solves = 0;                   ///< their number
  std::vector<double> values = {};  ///< of the free parameters
};

/// The samples of a job's pose set, by index: the same for each repetition.
[[nodiscard]] std::vector<int> study_poses(const StudySetup& setup, const StudyJob& job);

/// Measures, calibrates and judges.
[[nodiscard]] StudyTrial run_study_job(const StudySetup& setup, const StudyRobot& robot,
                                       const StudyJob& job);

/// The error of a robot's pose without a calibration, over all poses, RMS, metres.
/// @param truth  see study_truth()
[[nodiscard]] double error_before(const StudySetup& setup, ParameterValues truth);

}  // namespace kinecal
