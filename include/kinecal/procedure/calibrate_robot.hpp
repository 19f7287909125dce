// The procedure of a calibration, whichever way you come in: a robot, what may be wrong with it and samples in; the
// result, its verdict with reasons and causes, what would help and what to do next out.
//
//   Diagnostics found;
//   const CalibratedRobot calibrated = calibrate_robot({.robot = parse_urdf(urdf, "robot.urdf"),
//                                                       .config = parse_config(yaml, "calibrate.yaml", found),
//                                                       .samples = samples,
//                                                       .urdf_text = urdf});
//   if (calibrated.is_usable()) use(calibrated.result.table);
//
// 1. prepare(): offsets that the controller had added, what is held, lenses and where cameras begin, which points lie on
//    the surface of the robot (surface_rounds.hpp); then the problems are assembled and the input is doubted.  Errors end here, all of them at once.
// 2. Where nothing is free, what the samples support is searched for (search_robot()).
// 3. Solve, estimate the noise, leave out bad samples, assess, judge (calibrate_and_judge()).
// 4. What explains a bad fit, what would help, how fast is still good; what those see who read the files.
//
// The program, logs (calibrate_log()), capture sessions (SessionFollower) and crates (calibrate_crate.hpp) call it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/doubts/rising.hpp"
#include "kinecal/explain/suspect.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/report/findings.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/tools/identify/robot_search.hpp"

namespace kinecal {

/// A robot, what may be wrong with it, and what was recorded.
struct CalibrationSetup {
  Robot robot = {};
  std::optional<Config> config = {};    ///< nullopt: the one that the samples suggest
  std::vector<Sample> samples = {};     ///< in the order in which they were recorded
  std::string urdf_text = {};           ///< of the robot; empty: its text is not checked
  std::string urdf = "the URDF";        ///< its name in messages: the file
  Recorded recorded = Recorded::after;  ///< the samples, and `<calibration rising>`
  bool is_part = false;                 ///< there are more samples elsewhere: these may be few
};

/// When the free parameters are searched for.
enum class Search {
  never,
  if_open,  ///< where there is no configuration, or it frees nothing
  always
};

/// How calibrate_robot() works.
struct CalibrationOptions {
  SolveOptions solving = {};           ///< of all steps
  int folds = 5;                       ///< of held-out errors; 0: as many as samples; 1: none
  bool keep_outliers = false;          ///< no sample is left out
  std::vector<int> exclude = {};       ///< numbers of samples to leave out, from 1
  std::vector<std::string> hold = {};  ///< parameters, frames or candidates that keep their values
  std::vector<std::string> mesh_paths = {};  ///< where the URDF's packages may be, for its surface
  Search search = Search::if_open;
  bool geometry_only = false;  ///< a search frees no joint models, which a URDF cannot hold
  std::vector<std::string> between =
      {};           ///< sensors, links or frames: the report has +- of the pose of one in another
  int draw = 3000;  ///< of calibrate_log(): samples on which a log is judged
  std::vector<Suspect> suspects = {};          ///< what may be wrong beside what kinecal suspects
  OffsetStyle offsets = OffsetStyle::as_read;  ///< where the URDF will hold zeros
  std::set<std::string> in_servos = {};        ///< joints whose zeros the URDF does not get
  std::optional<Reader> reader = {};  ///< of the files, whose errors are judged; nullopt: urdf
  Progress progress = {};  ///< called in each iteration; what it throws ends the calibration
};

/// A setup that is ready to be solved, and what was found in it.
struct PreparedCalibration : CalibrationSetup {
  Calibration calibration =
      {};                    ///< assembled; without steps if the free parameters are searched for
  bool is_searched = false;  ///< they are
  bool decides_cameras = false;  ///< these samples decide lenses and where cameras begin
  Diagnostics diagnostics = {};  ///< errors: it cannot be solved
};

/// Decides what a setup leaves open, assembles and doubts it.
/// @param diagnostics  of its readers; with errors, the rest is only checked
/// @returns  a setup with a configuration, unless there are errors
[[nodiscard]] PreparedCalibration prepare(CalibrationSetup setup,
                                          const CalibrationOptions& options = {},
                                          Diagnostics diagnostics = {});

/// A calibrated robot: the result, its verdict, causes and what would help, with the setup that led to it.
struct CalibratedRobot : Findings {
  PreparedCalibration setup =
      {};  ///< all samples; the problems of the result, without those left out
  std::vector<Sample> samples = {};  ///< that the result uses, in the order of the problems
  std::vector<Sample> left_out_samples = {};     ///< those of `left_out`
  std::optional<RobotSearch> robot_search = {};  ///< that chose what is free

  /// False if the verdict is "do not use".
  [[nodiscard]] bool is_usable() const { return judgement.verdict != Grade::do_not_use; }
};

/// Calibrates and judges.
/// @throws InputError  with all errors of the input, one per line; if a sample to exclude does not exist, or too few
///                     samples are left
/// @{
[[nodiscard]] CalibratedRobot calibrate_robot(PreparedCalibration prepared,
                                              const CalibrationOptions& options = {});
[[nodiscard]] CalibratedRobot calibrate_robot(CalibrationSetup setup,
                                              const CalibrationOptions& options = {});
/// @}

namespace detail {

/// Runs a part of the procedure; what it says of unusable samples is an error of the input, too.
template <class Run>
auto as_input_error(const Run& run) {
  try {
    return run();
  } catch (const std::invalid_argument& error) {
    throw InputError(error.what());
  }
}

/// The procedure up to the verdict on the numbers: without causes and what would help.
[[nodiscard]] CalibratedRobot solve_and_judge(PreparedCalibration prepared,
                                              const CalibrationOptions& options);
/// Adds causes, what would help, and how fast is still good.
void explain(CalibratedRobot& calibrated, const CalibrationOptions& options);

}  // namespace detail

}  // namespace kinecal
