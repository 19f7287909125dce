// A file of poses: YAML or a bag, by its name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/config/capture/capture_config.hpp"
#include "kinecal/files/poses/poses.hpp"

namespace kinecal::cli {

/// By which readings of a joint that nobody has moved differ, radians or metres.
inline constexpr double kSamePosition = 0.005;

/// True for a line that ends a session by hand: q, or robot_calibration's done and exit, in any case.
[[nodiscard]] bool is_end(const std::string& line);

/// A position to which a joint can be sent: encoders may read a little beyond its limits.
[[nodiscard]] double within_limits(const Robot& robot, const std::string& joint, double position);

/// Checks that the robot has the joints of all chains.
/// @param file  of the configuration
/// @throws InputError  naming the first that it does not have; the others are printed
void check_chains(const std::string& file, const CaptureConfig& config, const Robot& robot);

/// Checks poses as a whole, before a robot moves: joints that it does not have, positions beyond
/// their limits, finders that the configuration does not have.  A little beyond is a warning.
/// @throws InputError  with one of them; the others are printed
void check_poses(const std::vector<CapturePose>& poses, const CaptureConfig& config,
                 const Robot& robot);

/// Poses of a file of any format.  Prints warnings and errors.
/// @throws InputError  if there are errors or no poses
[[nodiscard]] std::vector<CapturePose> read_pose_file(const std::string& path);

/// Writes poses in the format of the file's name.  The file gets its name when it is complete; without
/// poses, no file is written.
/// @throws InputError   if the name asks for another format
/// @throws OutputError  if the file cannot be written
void write_pose_file(const std::string& path, const std::vector<CapturePose>& poses);

}  // namespace kinecal::cli
