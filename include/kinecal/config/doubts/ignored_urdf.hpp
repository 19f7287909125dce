// Parts of a URDF that urdfdom takes and no chain can use.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal::detail {

/// Warns of joints that mimic a joint that does not exist, or themselves in a circle: they count as
/// joints of their own, as in ROS; and of joints that move about an axis of length zero.  An error if the errors so far say that the position
/// of such a joint is missing: this is their cause.
/// @param robot              of that URDF
/// @param text               the URDF, as parse_urdf() took it
/// @param name_for_messages  its file
void check_ignored_urdf(const Robot& robot, const std::string& text,
                        const std::string& name_for_messages, Diagnostics& diagnostics);

}  // namespace kinecal::detail
