// Photographs of a simulated robot: images, a table of joint positions, and the files that a user
// would have; also the truth, for judging a calibration.
//
//   images/0001.png ...   what the camera saw
//   depth/0001.png ...    of a camera3d: millimetres, 16 bits, 0 where nothing was measured
//   poses.csv             image, then the position of each joint, radians or metres
//   camera.yaml           camera_info as the driver reports it
//   calibrate.yaml        a first configuration
//   capture.yaml          the finder of the target, as robot_calibration has it
//   poses.yaml            the poses, as robot_calibration has them
//   truth.yaml            parameter: value, as calibration_<date>.yaml
//
// Of target robot, instead of capture.yaml:
//
//   samples.yaml          of a camera3d: clouds, background included
//   masks/0001.png ...    of a camera2d: 255 where the robot is, else 0
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kinecal/files/results/output_file.hpp"
#include "kinecal/tools/simulation/simulation_plan.hpp"

namespace kinecal {

/// Files of one folder.
struct PhotographFiles {
  std::vector<OutputFile> images;         ///< for images/
  std::vector<OutputFile> depth;          ///< for depth/; none of a camera without depth
  std::vector<OutputFile> masks;          ///< for masks/; only of target robot without depth
  std::vector<OutputFile> others;         ///< tables and configurations
  std::vector<std::string> skipped = {};  ///< poses without an image, and why
};

/// The files that describe a simulation, without images.
[[nodiscard]] std::vector<OutputFile> files_of(const SimulationPlan& plan,
                                               const std::vector<JointTarget>& poses);

/// Moves the robot to each pose, waits until it rests, and takes an image.
/// @param progress     called before each pose with its number, from 0; may be empty
/// @throws InputError  if there is no image
[[nodiscard]] PhotographFiles take_photographs(const SimulationPlan& plan,
                                               const std::vector<JointTarget>& poses,
                                               const std::function<void(std::size_t)>& progress);

}  // namespace kinecal
