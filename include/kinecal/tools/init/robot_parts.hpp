// Proposals for the questions of `kinecal init`: which links of a robot are likely to be the end of
// an arm, a camera or the base, and names for frames that the URDF does not contain.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/tools/init/init_answers.hpp"

namespace kinecal {

/// Links at the ends of chains that have at least three moving joints of their own; the chains with
/// most of them first.
[[nodiscard]] std::vector<std::string> propose_arms(const Robot& robot);

/// Links whose names contain "optical", colour before depth; then other links that look like
/// cameras.
[[nodiscard]] std::vector<std::string> propose_cameras(const Robot& robot);

/// The highest link from which a chain leads to this one: the root, unless a floating or planar
/// joint is in between.
/// @throws RobotError  if there is no such link
[[nodiscard]] std::string propose_base(const Robot& robot, const std::string& link);

/// Whether a frame that the URDF does not contain may have this name: no link has it, and no joint
/// has it or a similar one.
[[nodiscard]] bool is_free_frame_name(const Robot& robot, const std::string& name);

/// A name for a frame that the URDF does not contain.
/// @param names  candidates, the best first
[[nodiscard]] std::string propose_frame(const Robot& robot, std::vector<std::string> names);

/// The answers, completed with proposals for the base and the names of frames, which need not be
/// given.
/// @throws RobotError  if there is no link at the end of the chain
[[nodiscard]] InitAnswers with_proposals(const Robot& robot, InitAnswers answers);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/tools/init/robot_parts.ipp"
#endif
