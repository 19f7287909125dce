// A robot of which only the poses of its flange are known: what stands in for its URDF, and what the
// columns of its tables mean.
//
// Links and joints are in files/poses/hand_eye_names.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/poses/hand_eye_names.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The URDF of a flange and cameras.
/// @param camera_on_hand  on the flange; else beside the robot
/// @param cameras         their names: each is a link, on a joint <name>_joint
[[nodiscard]] std::string hand_eye_urdf(bool camera_on_hand,
                                        const std::vector<std::string>& cameras = {
                                            HandEyeNames::kCamera});

/// The configuration for samples that have poses of an object in the camera: read_hand_eye_samples().
/// @param camera_on_hand  on the flange, and the object in the world; else the other way around
[[nodiscard]] std::string hand_eye_pose_config(bool camera_on_hand);

/// A table of what a camera saw: a row for each corner.
struct CameraCorners {
  std::string camera;  ///< its name
  std::string file;    ///< image, id, u, v
};

/// Tables of a hand-eye calibration.
struct HandEyeTables {
  std::string poses;      ///< file: a row for each pose of the flange
  std::string form = {};  ///< of the poses, see pose_form(); empty: by names of columns
  bool inverse = false;   ///< the poses are those of the base in the flange
  std::vector<CameraCorners> corners = {};  ///< of each camera; empty: they are in photographs
  std::string target = {};      ///< file: where the corners are on the board; with `corners` only
  std::string holder = "arm";   ///< sensor_name of the board: what holds it
  bool camera_on_hand = false;  ///< else beside the robot
  bool has_marker = false;      ///< each row also has the pose of a marker in the camera
};

/// The text of a columns.yaml for these tables.  Columns are recognised by their names, with or without a word before or
/// behind them (tcp_x, x_marker): x y z with qx qy qz qw, q1 to q4 (ABB), rx ry rz, roll pitch yaw, A B C (KUKA), W P R
/// (Fanuc); or by their number and the form.  Units are those of names, else of values.  Corners have id, u, v and a column
/// that the table of poses has, too; the target id, x, y, z.
///
/// Names of angles do not say what they are: with corners or poses of a marker, the form is that which fits them, and a
/// comment has the others.  Without, rx ry rz are a rotation vector unless they are degrees, or longer than half a turn.
/// @param output_folder  of the columns.yaml, to which the names of tables are relative
/// @param diagnostics    receives a doubt if another form than the given one fits
/// @throws InputError  "file: ..." if a table cannot be read, what a column means is not clear, or no row of corners belongs
///                     to a pose
[[nodiscard]] std::string hand_eye_columns(const HandEyeTables& tables,
                                           const std::string& output_folder,
                                           Diagnostics& diagnostics);

/// Samples of cameras alone, from tables of corners that another program found: one for each image, with the observations of
/// the cameras and of 'board'.
/// @param corners  file: image, id, u, v; with several cameras also `camera`, the name of one
/// @param target   file: id, x, y, z of the corners on the board
/// @throws InputError  "file: ..." if a table cannot be read, or a corner is on no board
[[nodiscard]] std::vector<Sample> corner_samples(const std::string& corners,
                                                 const std::string& target,
                                                 const std::vector<std::string>& cameras);

}  // namespace kinecal
