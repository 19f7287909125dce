// Proposes what the columns of a table mean, by its header and its values.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/tools/init/init_answers.hpp"

namespace kinecal {

/// The first words of what proposed_columns() writes, by which it is recognised.
inline constexpr const char* kProposedColumnsMark = "# Columns for 'kinecal init', proposed";

/// The text of a columns.yaml for a table of joint positions and points that a tracker measured.  What was decided by
/// values and not by names, such as units, is said in comments, and so is every column that is not used.
///
/// Joints are recognised by their names in the URDF, with or without "_joint", "_pos", units; or as q1 q2 ..., j1, axis_1
/// and the like, if an arm of the robot has as many.  Velocities are dq1 dq2 ..., qd1, or joints' names with "_velocity",
/// "_vel" or a unit per second; they are proposed if every joint has one in every row.  Points are three columns x, y, z with a common rest of their names;
/// of several, those that are called after a tracker.  A table without a header has the joints of the arm, then x, y, z.
/// Of a target that a tip touches, a table has the joints, and of several sockets a column that names the one of each row.
/// @param robot  whose joints the columns hold
/// @param table  the text
/// @param file   its name, in messages
/// @param target  what the tip touches, or a tracker; nullopt: by the columns
/// @param sockets_file  of sockets with known places, with the columns socket, x, y, z in metres; empty: not known
/// @param tip           frame of the tip, or the link that it is; of hands that hold one thing, one of their links; empty: proposed
/// @throws InputError  "file: ...": what neither names nor values tell
[[nodiscard]] std::string proposed_columns(const Robot& robot, std::string_view table,
                                           const std::string& file,
                                           std::optional<InitTarget> target = {},
                                           const std::string& sockets_file = {},
                                           const std::string& tip = {});

/// The target for which proposed_columns() wrote a columns.yaml; nullopt: a tracker, or it is not of these.
[[nodiscard]] std::optional<InitTarget> target_of_columns(std::string_view text);

/// The table of two sockets whose distance is known, for a table of joints that names the one of each row.
/// @param length  metres
/// @throws InputError  "file: ..." if no column names them, or it names another number of sockets
[[nodiscard]] std::string sockets_at_distance(std::string_view table, const std::string& file,
                                              double length);

}  // namespace kinecal
