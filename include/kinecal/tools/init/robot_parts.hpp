// Default answers for `kinecal init`: likely links for the end of an arm, a camera and the base,
// and names for frames that are not in the URDF.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/tools/init/init_answers.hpp"

namespace kinecal {

/// Links at the ends of chains with at least three moving joints of their own; longest chains
/// first.  Legs only if there is nothing else.
[[nodiscard]] std::vector<std::string> propose_arms(const Robot& robot);

/// Links with "optical" in their names, colour before depth; then other links that look like
/// cameras.
[[nodiscard]] std::vector<std::string> propose_cameras(const Robot& robot);

/// The highest link with a chain to this one: the root, unless a floating or planar joint is in
/// between.
/// @throws RobotError  if there is no such link
[[nodiscard]] std::string propose_base(const Robot& robot, const std::string& link);

/// The one of some joints that is between a link and the root; empty if none is, or there is no such link.
[[nodiscard]] std::string joint_above(const Robot& robot, const std::string& link,
                                      const std::vector<std::string>& joints);

/// True if a frame outside the URDF may have this name: no link has it, and no joint has it or a
/// similar one.
[[nodiscard]] bool is_free_frame_name(const Robot& robot, const std::string& name);

/// A name for a frame that is not in the URDF.
/// @param names  candidates, the best first
[[nodiscard]] std::string propose_frame(const Robot& robot, std::vector<std::string> names);

/// The answers, completed with defaults for the base and the names of frames, which are optional.
/// @throws RobotError  if the link at the end of the chain does not exist
[[nodiscard]] InitAnswers with_proposals(const Robot& robot, InitAnswers answers);

}  // namespace kinecal
