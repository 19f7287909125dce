// A result, read back from the folder that calibrate wrote, to be held against new samples or
// another result: the files that result_folder.hpp reads, with what they were calibrated from.
//
//   report.json     values, covariance, noise, poses, the verdict
//   original.urdf   the robot before the calibration
//   config.yaml     the configuration
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/report/recorded_poses.hpp"
#include "kinecal/trust/verify/drift.hpp"

namespace kinecal {

/// Distances of the features of an error block in the calibration, metres or pixels.
struct FittedBlock {
  double distance = 0.0;           ///< root of the mean square
  std::optional<double> held_out;  ///< of samples that were held out
};

/// Two frames, the pose of one in the other being what the robot needs.
struct PoseInQuestion {
  FrameOnRobot frame;     ///< whose pose
  FrameOnRobot in;        ///< in which
  double position = 0.0;  ///< standard deviation of the position, metres
};

/// A number of a camera file, and its standard deviation: infinite if it was not calibrated.
struct StoredNumber {
  double value = 0.0, deviation = 0.0;  ///< pixels, or as D has it
};

/// A result and what it was calibrated with.
struct StoredResult {
  std::string folder;     ///< as the user gave it
  std::string report;     ///< path of report.json, for messages
  std::string verdict;    ///< "good" or "use with care"
  Robot robot;            ///< of the original URDF
  std::string urdf_text;  ///< the original URDF
  std::string urdf;       ///< its path
  std::string urdf_then;  ///< its path when it was calibrated, as the user gave it; may be empty
  Config config;          ///< with which it was calibrated
  std::map<std::string, double> values;         ///< of calibration.yaml
  std::vector<std::string> parameters;          ///< those that were free
  std::vector<std::vector<double>> covariance;  ///< of them: rows of the lower triangle
  /// Combinations of parameters without effect: names and factors.
  std::vector<std::vector<std::pair<std::string, double>>> undetermined;
  std::vector<BlockNoise> noise;              ///< of each error block
  CommonNoise common;                         ///< that features of a pose share
  bool knows_common = false;                  ///< report.json has it; of older versions it has not
  std::map<std::string, FittedBlock> fitted;  ///< by error block
  std::optional<PoseInQuestion> pose;         ///< the one that the robot needs, if that is known
  RecordedPoses poses;                        ///< those of the samples
  std::map<std::string, double> deviations;  ///< of calibrated parameters; infinite: not determined
  std::map<std::string, std::string> units;  ///< of calibrated parameters
  /// Intrinsics and coefficients as camera files have them, by parameter; of cameras that report.json has a map of.
  std::map<std::string, StoredNumber> camera_numbers;
  /// What the driver adds to readings by calibrated.urdf less by the original one, by joint; not zero:
  /// <calibration rising>, and offsets of <ros2_control>.
  std::map<std::string, double> added_offsets;

  /// Values of all parameters of a table; of those that the result does not have, zero.
  [[nodiscard]] std::vector<double> values_of(const ParameterTable& table) const;
  /// What check_drift() needs of it.
  /// @throws InputError  if the configuration has no longer a parameter that was calibrated
  [[nodiscard]] CalibratedState state(const ParameterTable& table) const;
  /// The poses as samples without observations.
  [[nodiscard]] std::vector<Sample> pose_samples() const;
};

/// Reads a result.
/// @throws InputError  with the file and what to do if it is not one, incomplete, or was changed
[[nodiscard]] StoredResult read_result(const std::string& folder);

}  // namespace kinecal
