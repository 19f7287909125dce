// Checks lengths and angles of a URDF: millimetres, degrees.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal::detail {

/// Error: origins between the base link and a model in millimetres, kilometres or degrees.  Doubt:
/// only one of them; limits in degrees.  Warning: a lower limit above the upper one.
/// @param text               the URDF, as given to parse_urdf()
/// @param name_for_messages  its file
void check_urdf_units(const Config& config, const Robot& robot, const std::string& text,
                      const std::string& name_for_messages, Diagnostics& diagnostics);

}  // namespace kinecal::detail
