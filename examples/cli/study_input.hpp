// What studies, selections and plans start from: a robot, what is calibrated, poses, and the noise.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "kinecal/capture/session/capture_pose.hpp"
#include "kinecal/config/config.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/study/repeatability.hpp"
#include "kinecal/tools/simulation/simulation_plan.hpp"

namespace kinecal::cli {

/// A robot and its study.  It stays where it was made: the setup refers to it.
struct StudyInput {
  Robot robot;
  Config config;
  SimulationPlan plan;
  std::string urdf_text;                                   ///< content of the URDF
  std::vector<CapturePose> poses;                          ///< one for each sample
  std::vector<Sample> samples;                             ///< recorded ones, or those of the poses
  Calibration calibration;                                 ///< of these samples
  StudySetup setup;                                        ///< without truth and noise of a job
  std::vector<std::pair<std::string, std::string>> files;  ///< that were read: role and name
  ShellCommand command;                                    ///< as the user typed it
  std::size_t have = 0;  ///< the last samples, which exist already
  /// It compares the robot with its own surface: what is seen of it belongs together already, so calibrations of it are not
  /// simulated.
  bool is_of_surface = false;
  bool is_touched =
      false;  ///< a tip touches something in generated poses: there is no sensor to simulate
  /// Standard deviation of the judged pose, metres, by the calibration of recorded clouds or masks; nullopt: of others.
  std::optional<double> calibrated = {};
  bool keep_ruined = true;  ///< calibrate with all samples
  /// Values of all parameters by the configuration: those of its simulated target can differ.
  std::vector<double> configured;
  /// Parameters of two explanations, which are free, too; empty: none.
  std::array<std::vector<std::string>, 2> explanations = {};
};

/// Reads everything.  Prints warnings.
/// @param poses  how many to generate, if there are neither samples nor a file of poses
/// @throws InputError  with one of the errors; the others are printed
[[nodiscard]] std::unique_ptr<StudyInput> read_study(const StudyFiles& files, int poses);

/// Calibrates samples of the study as `kinecal calibrate` does, but without its statements.
/// @param config  the study's, or one that differs from it in error blocks
[[nodiscard]] StudyFit fit_study(const StudyInput& input, const Config& config,
                                 std::span<const Sample> all);

/// Names of the free parameters, in their order.
[[nodiscard]] std::vector<std::string> free_names(const StudyInput& input);

}  // namespace kinecal::cli
