// Writes the first configuration of a robot: URDF and a few answers in, commented YAML out.
//
// Pure functions: the program asks the questions and writes the file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/tools/init/init_answers.hpp"
#include "kinecal/tools/init/robot_parts.hpp"

namespace kinecal {

/// Reports a link that the robot does not have, or a missing answer.
/// @param option  of the command line, for messages
void check_init_link(const Robot& robot, const std::string& option, const std::string& link,
                     Diagnostics& diagnostics);

/// Reports a name that is not allowed for a frame outside the URDF.
void check_init_frame(const Robot& robot, const std::string& option, const std::string& name,
                      Diagnostics& diagnostics);

/// Reports a length that a target does not have, or that is none.
/// @param length  metres
void check_init_length(InitTarget target, double length, Diagnostics& diagnostics);

/// Reports a known place that a target does not have, or that is none.
/// @param at  metres
void check_init_place(InitTarget target, const Vector3<double>& at, Diagnostics& diagnostics);

/// Reports a camera name that another model already has.
void check_init_camera_name(const std::string& option, const std::string& name,
                            Diagnostics& diagnostics);

/// The text of a configuration, in robot_calibration's ROS 1 dialect.
/// @param given  may omit the base and the names of frames: see with_proposals()
/// @throws InputError  "--option: what is wrong; what to do": a link that does not exist or cannot
///                     be reached, or a target that determines nothing of this robot
[[nodiscard]] std::string initial_config(const Robot& robot, const InitAnswers& given);
/// The same for several cameras or arms in one problem: frees what the samples of each camera with each arm determine, but the frame
/// between two arms once.
/// @param given  answers for each camera with what it sees: of one base
[[nodiscard]] std::string initial_config(const Robot& robot, const std::vector<InitAnswers>& given);

}  // namespace kinecal
