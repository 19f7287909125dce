// Assigns meaning to a table's columns, by a small YAML file.
//
//   separator: comma                # comma (default), semicolon, tab or space
//   header: true                    # the first row contains the columns' names; default true
//   joints:
//     unit: degrees                 # radians (default) or degrees; metres or millimetres for
//     columns: {joint_1: q1, ...}   #   prismatic joints: sliding: {unit: ..., columns: ...}
//   poses:                          # measured poses of floating joints: instead of joints, or beside
//     flange_joint: {form: kuka, columns: [X, Y, Z, A, B, C]}   # see files/poses/pose_numbers.hpp;
//                                   #   unit: millimetres, angles: degrees, inverse: true
//   velocities:                     # of all joints or of none
//     unit: deg/s                   # rad/s (default) or deg/s; m/s or mm/s for prismatic joints:
//     columns: {joint_1: dq1, ...}  #   sliding_velocities: {unit: ..., columns: ...}
//   conditions: {temperature: t_air}   # numbers that come with each sample, in units of your own; one in
//                                   #   degrees or millimetres: track_yaw: {column: yaw, unit: degrees}
//   increments: {left_wheel: dl}    # conditions, too, given as what they grew by since the row before; of x, y and yaw of
//                                   #   a pose, such as track_x track_y track_yaw, as the motion seen from the pose before
//   observations:
//    - sensor: arm
//      frame: reflector
//      constant: [0, 0, 0]          # the same point in every row; unit as for points.  Several:
//                                   #   [[0, 0, 0], [0.1, 0, 0]]
//    - sensor: tracker
//      frame: tracker_frame
//      unit: millimetres            # metres (default) or millimetres
//      points: [[[tx, dx], [ty, dy], [tz, dz]]]   # a list of columns means their sum, 0: zero
//    - sensor: camera
//      frame: optical_frame
//      pixels: [[u1, v1], [u2, v2]]
//      ids: [4, 7]                  # of the points, pixels or constants: what pairs the sensors'
//                                   #   features.  From columns: id_columns: [tag1, tag2]
//    - sensor: camera               # poses of an object: form, unit, angles and inverse as under poses
//      frame: camera
//      form: rotation_vector
//      poses: [[mx, my, mz, mrx, mry, mrz]]     # or constant_poses: numbers, the same in every row
//    - sensor: camera               # features in a table of their own, a row for each feature:
//      frame: optical_frame
//      table: corners.csv           # beside this file
//      match: image                 # a column of both tables; without it, each sample has all rows
//      pixels: [[u, v]]
//      id_columns: [id]
//    - sensor: scanner              # a file for each sample: cells of the row stand in for {columns}, or, where no
//      frame: scanner               #   column names the files, lines/*.txt are those of the rows in natural order;
//      table: lines/{file}.txt      #   also PLY and PCD, whose columns are named x, y, z
//      separator: space             # of this table, if they differ from the samples'
//      header: false
//      unit: millimetres
//      points: [[1, 0, 2]]
//   group: pose                     # rows with the same cell are one sample: a row for each of its points
//
// Give a column by its name or by its number from 1.  Each point becomes a feature.  A sensor may
// occur several times with different frames: its features are appended.  If the frame changes from
// row to row, use frame_column: reflector instead of frame; with `frame: socket` beside it, a cell 2 means socket_2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/poses/pose_numbers.hpp"
#include "kinecal/geometry/rotation.hpp"

namespace kinecal {

/// A column as named by the user.
struct CsvColumn {
  std::string name;      ///< as in the header, or its number from 1
  SourceLocation place;  ///< where the mapping names it
};

/// Columns to add up; usually one.
using CsvSum = std::vector<CsvColumn>;

/// The unit of a column; radians or metres if both are false.
struct CsvUnit {
  bool degrees = false;      ///< else radians
  bool millimetres = false;  ///< else metres
};

/// The position or the velocity of one joint in every sample.
struct CsvJoint {
  std::string name;  ///< of the joint in the URDF
  CsvSum columns;    ///< whose sum it is
  CsvUnit unit;      ///< of the columns; per second for a velocity
};

/// The measured pose of a floating joint in every sample.
struct CsvPose {
  std::string joint;    ///< its name in the URDF
  PoseForm form = {};   ///< of the numbers
  CsvSum columns = {};  ///< one for each number: not a sum
};

/// A condition of every sample: a temperature, a load.
struct CsvCondition {
  std::string name;        ///< of the condition
  CsvSum columns;          ///< whose sum it is
  CsvUnit unit = {};       ///< of the columns
  bool increment = false;  ///< the columns are what it grew by since the row before
};

/// One observation of every sample.
struct CsvObservation {
  std::string sensor;   ///< sensor_name of the observation
  std::string frame;    ///< in which its points are given
  CsvSum frame_column;  ///< one column that names the frame, behind `frame` and '_'; empty: `frame`
  CsvUnit unit;         ///< of the columns of its points
  std::vector<std::array<CsvSum, 3>> points;  ///< an empty sum is zero: the third one of a pixel
  std::vector<Vector3<double>> constants;     ///< metres
  PoseForm form = {};                         ///< of its poses
  std::vector<CsvSum> poses = {};             ///< each: a column for each number of the form
  std::vector<Pose<double>> constant_poses = {};  ///< metres
  std::vector<int> ids;                           ///< of each feature; empty: not given here
  CsvSum id_columns;                              ///< one column for each; empty: see `ids`
  std::string table =
      {};  ///< path of a table of its own, of several if it has {column} or *; empty: the samples'
  SourceLocation table_place = {};  ///< where the mapping names it
  char separator = ',';             ///< of the table of its own
  bool header = true;               ///< of the table of its own
  CsvSum match = {};                ///< one column of both tables; empty: all rows belong

  /// True if each sample has a file of its own.
  [[nodiscard]] bool has_files() const { return table.find_first_of("{*") != std::string::npos; }
};

/// What the columns of a table mean.
struct CsvMapping {
  char separator = ',';                      ///< between cells; ' ' for one or more blanks
  bool header = true;                        ///< the first row names the columns
  std::vector<CsvJoint> joints;              ///< positions in every sample
  std::vector<CsvPose> poses;                ///< in every sample
  std::vector<CsvJoint> velocities;          ///< of all joints, in their order; or empty
  std::vector<CsvCondition> conditions;      ///< of every sample
  std::vector<CsvObservation> observations;  ///< of every sample
  CsvSum group =
      {};  ///< one column: rows with the same cell are one sample; empty: each row is one
};

/// What a table is read for.
enum class CsvUse {
  samples,  ///< joints, poses and observations
  joints    ///< joints and poses only: the observations are elsewhere, such as in photographs
};

/// Reads the meaning of columns.  Collects all errors; with errors, the mapping is incomplete.
/// @param use  for joints only, observations may be missing, and those that are there are left out
/// @throws InputError  "file:line: ..." if the file cannot be read or is not YAML
[[nodiscard]] CsvMapping read_csv_mapping(const std::string& path, Diagnostics& diagnostics,
                                          CsvUse use = CsvUse::samples);

}  // namespace kinecal
