// Samples that other programs of hand-eye calibration saved: poses of the flange and of an object in the
// camera, metres.
//
//   MoveIt Calibration   - effector_wrt_world: [16 numbers]    base_T_flange, 4 x 4 by rows
//                          object_wrt_sensor: [16 numbers]     camera_T_object
//   easy_handeye2        samples:
//                        - robot: {translation: {x, y, z}, rotation: {x, y, z, w}}
//                          tracking: the same                  camera_T_object
//
// `robot` is base_T_flange for a camera on the hand, and flange_T_base for one beside the robot.
// Source: moveit_calibration, handeye_control_widget.cpp; easy_handeye2, handeye_sampler.py.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A sample of both poses, with the names of HandEyeNames: the pose of the flange's floating joint, that of the
/// object as an observation of the camera, and the identity as one of what holds the object.
[[nodiscard]] Sample hand_eye_sample(const Pose<double>& base_T_flange,
                                     const Pose<double>& camera_T_object);

/// True if a file begins like one of these; false for streams, which can be read only once.
[[nodiscard]] bool is_hand_eye_samples(const std::string& path);

/// The samples, each a hand_eye_sample().
/// @param camera_on_hand  decides what `robot` of easy_handeye2 is, where the file does not say it;
///                        nullopt: unknown
/// @param diagnostics     receives every error, "file:line: ...", also if the file is not YAML
[[nodiscard]] std::vector<Sample> read_hand_eye_samples(const std::string& path,
                                                        std::optional<bool> camera_on_hand,
                                                        Diagnostics& diagnostics);

}  // namespace kinecal
