// A file of poses: YAML or a bag, by its name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/io/capture/capture_config.hpp"
#include "kinecal/io/poses/poses.hpp"

namespace kinecal::cli {

/// Poses of a file of any format.  Prints warnings and errors.
/// @throws InputError  if there are errors or no poses
[[nodiscard]] std::vector<CapturePose> read_pose_file(const std::string& path);

/// What poses must go with.
struct PoseDemands {
  const Robot& robot;                ///< has their joints
  std::vector<std::string> finders;  ///< names that they may ask for
};

/// Checks all poses of a file before a robot moves: joints and finders that do not exist, in one error;
/// positions beyond the limits, as warnings.
/// @throws InputError  naming the poses, with the nearest names
void check_poses(const std::string& path, const std::vector<CapturePose>& poses,
                 const PoseDemands& demands);

/// Checks that the robot has the joints of all chains.
/// @param path  of the configuration
/// @throws InputError  naming those that it does not have, with the nearest names
void check_chains(const std::string& path, const CaptureConfig& config, const Robot& robot);

/// Names of all finders.
[[nodiscard]] std::vector<std::string> finder_names(const CaptureConfig& config);

/// Writes poses in the format of the file's name.  The file gets its name when it is complete; without
/// poses there is none.
/// @throws InputError   if the name asks for another format
/// @throws OutputError  if the file cannot be written
void write_pose_file(const std::string& path, const std::vector<CapturePose>& poses);

}  // namespace kinecal::cli
