// A result, read back from the folder that calibrate wrote, to be held against new samples or
// another result.
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
#include "kinecal/trust/drift.hpp"

namespace kinecal::cli {

/// Distances of the features of an error block in the calibration, metres or pixels.
struct FittedBlock {
  double distance = 0.0;           ///< root of the mean square
  std::optional<double> held_out;  ///< of samples that were held out
};

/// Two frames, the pose of one in the other being what the robot needs.
struct PoseInQuestion {
  FrameOnRobot frame, in;
  double position = 0.0;  ///< standard deviation of the position, metres
};

/// A result and what it was calibrated with.
struct Result {
  std::string folder;   ///< as the user gave it
  std::string report;   ///< path of report.json, for messages
  std::string verdict;  ///< "good" or "use with care"
  Robot robot;          ///< of the original URDF
  std::string urdf_text, urdf;
  Config config;
  std::map<std::string, double> values;  ///< of calibration.yaml
  std::vector<std::string> parameters;   ///< those that were free
  std::vector<std::vector<double>> covariance;
  std::vector<std::vector<std::pair<std::string, double>>> undetermined;
  std::vector<BlockNoise> noise;
  std::map<std::string, FittedBlock> fitted;  ///< by error block
  std::optional<PoseInQuestion> pose;
  RecordedPoses poses;
  std::map<std::string, double> deviations;  ///< of calibrated parameters; infinite: not determined
  std::map<std::string, std::string> units;  ///< of calibrated parameters
  std::map<std::string, double>
      added_rising;  ///< by which calibrated.urdf changes what drivers read

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
[[nodiscard]] Result read_result(const std::string& folder);

}  // namespace kinecal::cli
