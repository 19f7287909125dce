// The content of the HTML report and its charts, as plain numbers and text.
//
// Charts are drawn only from this, so a calibration, a comparison and a study share them.
// Units: metres, radians, pixels; charts convert to millimetres, degrees and per cent.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/report/findings.hpp"
#include "kinecal/report/robot_scene.hpp"
#include "kinecal/trust/uncertainty/projection_map.hpp"
#include "kinecal/trust/uncertainty/workspace_map.hpp"

namespace kinecal {

/// An input file of a calibration.
struct InputFile {
  std::string role;         ///< "URDF", "configuration", "samples", "camera"
  std::string name;         ///< path, as the user gave it
  std::uint64_t bytes = 0;  ///< its size
  std::string sha256;       ///< of its content, 64 hexadecimal digits
};

/// Residual of one feature, before and after.
struct ReportedFeature {
  int sample = 0;             ///< index into ReportData::samples
  FeatureLabel feature = {};  ///< which one of the sample it is
  double before =
      0.0;             ///< distance at the initial values, unit of the block; not finite: undefined
  double after = 0.0;  ///< the same at the result
  std::vector<double> residual = {};  ///< its components at the result, unit of the block
  std::optional<std::array<double, 2>> pixel =
      {};  ///< where a camera observed it; blocks in pixels only
  /// Where the outline of the robot should be in the image of a mask, pixels: at the initial values, unless a pose was
  /// searched for, and at the result.
  std::optional<std::array<double, 2>> outline_before = {}, outline_after = {};
  std::optional<double> depth = {};  ///< from the depth camera, metres
  std::optional<std::array<double, 3>> point =
      {};  ///< where a depth camera saw it, in the base, metres
};

/// An error block.
struct ReportedBlock {
  std::string name;          ///< of the configuration
  std::string type;          ///< "chain3d_to_chain3d"
  std::string unit;          ///< of the residual: "m", "px" or "1"
  bool is_plane = false;     ///< it compares with a plane: the error varies over the floor
  int components = 1;        ///< residuals of a feature
  double sigma = 0.0;        ///< estimated noise of a component; 0: unknown
  double sigma_given = 0.0;  ///< of the configuration; 0: none
  double rms_before = 0.0;   ///< root of the mean squared distance of features
  double rms_after = 0.0;    ///< the same at the result
  std::optional<double> held_out = {};  ///< the same for held-out samples
  std::array<double, 2> image = {
      0.0, 0.0};  ///< width and height of the camera's image, pixels; 0: unknown
  std::vector<ReportedFeature> features = {};  ///< in the order of samples, also of those left out
  std::vector<std::string> cameras = {};       ///< names of those whose features it compares
};

/// A sample, used or left out.
struct ReportedSample {
  int number = 0;         ///< from 1, in the order of the files
  std::string source;     ///< source location
  bool bad = false;       ///< it does not fit the others
  bool left_out = false;  ///< not used by the fit
  std::string why;        ///< its fault and the likely cause; may be empty
  double times = 0.0;     ///< distance of its worst feature in standard deviations of the noise
};

/// A calibrated parameter.
struct ReportedParameter {
  std::string name, owner;  ///< owner: joint, frame, sensor or error block
  std::string unit;         ///< "rad", "m", "1" or "px"
  double value = 0.0, initial = 0.0;
  std::optional<double> sigma;  ///< standard deviation; nullopt: not determined, or at a bound
  std::string
      note;  ///< "", "not significant", "not determined", "hardly determined", "at its bound", kInCamera
};

/// Notes a parameter whose value is among the numbers of its camera, in pixels.
inline constexpr const char* kInCamera = "see camera";

/// The content of a report.
struct ReportData {
  std::string robot;  ///< its name
  Grade verdict = Grade::good;
  std::vector<std::string> reasons;  ///< for the verdict: causes, then worst first
  std::vector<std::string> helps;    ///< held parameters that would lower the error
  ReadBack read_back;                ///< what those see who read the files
  std::string next;                  ///< what to do: see next_step()
  std::string version;               ///< "kinecal 0.2.0"
  ShellCommand command;              ///< repeats the run
  std::string date;                  ///< "2026-11-23"; of the calibration
  std::string recorded;              ///< when samples were recorded; empty: unknown
  std::vector<InputFile> inputs;
  ReportedSearch search;          ///< that chose the free parameters
  std::vector<StepResult> steps;  ///< with the cost of each iteration
  std::vector<ReportedBlock> blocks;
  std::int64_t solved = 0;  ///< samples of the result
  std::int64_t drawn =
      0;  ///< of these, the ones that are shown and by which a log was judged; 0: all
  std::vector<ReportedSample> samples;  ///< used ones by number in the problem, then those left out
  std::vector<ReportedParameter> parameters;
  std::vector<std::string> correlated;           ///< names: rows and columns of the matrix below
  std::vector<std::vector<double>> correlation;  ///< (correlated x correlated), -1 to 1
  /// Combinations that affect no residual: parameter names and factors.
  std::vector<std::vector<std::pair<std::string, double>>> unobservable;
  std::vector<std::string> hold;          ///< parameters to hold so that all others are observable
  int rank = 0;                           ///< number of combinations that are observable
  std::vector<PoseUncertainty> compared;  ///< of the frames that error blocks compare
  std::vector<PoseUncertainty> between;   ///< of --between
  std::vector<KnownPoint> workspace;   ///< of the origin of that pose, over the robot's workspace
  std::vector<ProjectionMap> cameras;  ///< how well they are known, of which something is free
  std::string summary;                 ///< the report as text
};

/// Collects the content of a calibration's report, except its inputs, date and command.
/// @param calibration  the one that was solved, with its samples
/// @param samples      those of its problems, in their order
/// @param left_out     those of Findings::left_out, in their order; empty: without their residuals
[[nodiscard]] ReportData report_data(const Calibration& calibration, const Findings& findings,
                                     std::span<const Sample> samples,
                                     std::span<const Sample> left_out = {});

/// Adds the positions of planes' features in the base, for those in a scene of the same
/// calibration.
void add_points(const RobotScene& scene, ReportData& data);

}  // namespace kinecal
