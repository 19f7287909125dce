// How well calibrations repeat: simulated robots, each calibrated several times with several numbers of
// poses, and the variance of each parameter beside the one that the covariance predicts.
//
// A study is a list of jobs.  Each job has its own random numbers, so jobs may run in any order, on any
// number of threads and machines, and give the same tables.
// Source: the Fetch paper, IV: variance over ten calibrations with 100, 50 and 25 poses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/study/error_sizes.hpp"
#include "kinecal/study/exact_samples.hpp"
#include "kinecal/study/measurement_noise.hpp"
#include "kinecal/trust/pose_uncertainty.hpp"

namespace kinecal {

/// What a calibration of simulated samples found.
struct StudyFit {
  bool converged = false;
  std::vector<double> values;  ///< of all parameters of the table
  int left_out = 0;            ///< samples that did not fit
  double seconds = 0.0;        ///< of all its solves
  int solves = 1;              ///< more than one if samples were left out
};

/// What is studied.
struct StudySetup {
  MakeProblem make;             ///< the last step without samples
  std::vector<int> free;        ///< table indices of its free parameters
  std::vector<double> drawn;    ///< values of all parameters of a robot without errors
  std::vector<Sample> samples;  ///< poses and targets: see exact_samples()
  FrameOnRobot frame, in;       ///< whose pose is judged, and in which frame
  MeasurementNoise noise = {};
  ErrorSizes errors = {};
  double ruined = 0.0;        ///< share of samples of which a joint is elsewhere than it says
  double ruined_by = 0.05;    ///< radians or metres
  std::uint64_t seed = 1;     ///< the same one: the same robots and noise
  bool free_targets = false;  ///< also say what six unknowns for each target would give
  std::function<StudyFit(std::span<const Sample>)> fit;  ///< calibrates, as a user would
};

/// A simulated robot.
struct StudyRobot {
  int number = 0;               ///< from 0
  std::vector<double> truth;    ///< of all parameters of the table
  std::vector<Sample> samples;  ///< as it would measure them without noise
};

/// The true values of all parameters of a robot.
[[nodiscard]] std::vector<double> study_truth(const StudySetup& setup, int number);

/// A robot, with the samples that it would measure.
/// @throws StudyError  if a sample cannot be measured by it
[[nodiscard]] StudyRobot study_robot(const StudySetup& setup, int number);

/// One calibration of one robot.
struct StudyJob {
  int robot = 0;   ///< from 0
  int poses = 0;   ///< how many samples
  int repeat = 0;  ///< from 0

  /// By robot, then by poses, the most first, then by repetition.
  friend bool operator<(const StudyJob& a, const StudyJob& b) {
    if (a.robot != b.robot) return a.robot < b.robot;
    return a.poses != b.poses ? a.poses > b.poses : a.repeat < b.repeat;
  }
};

/// What became of it.
struct StudyTrial {
  StudyJob job = {};
  bool converged = false;
  int ruined = 0;             ///< samples that were ruined
  int left_out = 0;           ///< samples that the calibration left out
  double position = 0.0;      ///< error of the pose that is judged, over all poses, RMS, metres
  double rotation = 0.0;      ///< the same, radians
  double reprojection = 0.0;  ///< mean distance of features of new samples, in the block's unit
  double systematic = 0.0;    ///< the same of samples without noise: what the calibration left
  /// Distance of the residuals from those of the linearized problem, over what its solution changes of
  /// them: below 0.1, variances are those of the covariance.
  double nonlinearity = 0.0;
  double seconds = 0.0;             ///< of the calibration's solves
  int solves = 0;                   ///< how many they were
  std::vector<double> values = {};  ///< of the free parameters
};

/// The samples of a job's pose set, by index: the same ones for each repetition.
[[nodiscard]] std::vector<int> study_poses(const StudySetup& setup, const StudyJob& job);

/// Measures, calibrates and judges.
[[nodiscard]] StudyTrial run_study_job(const StudySetup& setup, const StudyRobot& robot,
                                       const StudyJob& job);

/// The error of a robot's pose without a calibration, over all poses, RMS, metres.
/// @param truth  see study_truth()
[[nodiscard]] double error_before(const StudySetup& setup, std::span<const double> truth);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/study/repeatability.ipp"
#endif
