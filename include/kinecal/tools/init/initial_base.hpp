// The first configuration of a mobile base: which drive, what shows how it moved, its dimensions; and what the columns of a
// table of a drive mean.
//
// Pure functions, as initial_config.hpp: the program asks the questions and writes the files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The drives, and what is seen of their motion, as error blocks name them: <drive>_to_<seen>.
inline constexpr std::array<std::string_view, 4> kBaseDrives = {"odometry", "differential",
                                                                "mecanum", "tricycle"};
inline constexpr std::array<std::string_view, 2> kBaseSeen = {"wall", "pose"};

/// Dimensions of a drive, metres; zero: not known.
struct BaseSizes {
  double wheel_radius = 0.0;  ///< of the wheels that drive
  double track_width = 0.0;   ///< between the wheels of an axle
  double wheelbase = 0.0;     ///< between the axles
};

/// The facts about a base that a first configuration needs.
struct BaseAnswers {
  std::string base_link = "base_link";
  std::string drive;               ///< one of kBaseDrives; empty: only a gyroscope
  std::string seen;                ///< one of kBaseSeen
  bool has_gyro = false;           ///< a gyroscope, with times
  bool turns = true, runs = true;  ///< the drive turns, and goes somewhere
  bool sideways = false,
       steers = false;      ///< it goes to the side (mecanum), steers by several angles
  BaseSizes sizes;          ///< nominal
  double gyro_scale = 0.0;  ///< of its driver; zero: not known
  std::optional<std::array<double, 3>>
      mount;               ///< x, y, yaw of the sensor on the base; nullopt: not known
  std::string mount_from;  ///< where they are from, for a comment
};

/// What samples of a drive have: the drives, in the order of kBaseDrives, that a block can take, what is seen, a gyroscope, and
/// whether the base turned by more than a radian, went straight farther than 0.3 m, to the side by a tenth of its way, and
/// steered by angles that differ by more than 0.3 radians.
struct RecordedBase {
  std::vector<std::string> drives, seen;
  bool has_gyro = false;
  bool turns = true, runs = true;
  bool sideways = false, steers = false;
};
/// What these samples have.
[[nodiscard]] RecordedBase recorded_base(std::span<const Sample> samples);

/// The link of a base: the first of some names that is a link, else base_link, else the root.
/// @param names  empty ones do not count
[[nodiscard]] std::string base_link_of(const Robot& robot,
                                       const std::vector<std::string>& names = {});

/// The dimensions of a drive by the wheel joints of a URDF, and by their cylinders or spheres.
/// @param urdf_text  of the robot
/// @param drive      one of kBaseDrives
[[nodiscard]] BaseSizes sizes_of_urdf(const Robot& robot, const std::string& urdf_text,
                                      const std::string& base_link, std::string_view drive);

/// The text of a configuration.
[[nodiscard]] std::string initial_base(const BaseAnswers& answers);

/// The text of a columns.yaml for a table of a drive, by the names of its columns; what is not used is said in a comment.
/// @param table  the text
/// @param file   its name, in messages
/// @throws InputError  "file: ...": without a drive, or without what shows how the base moved; an angle of the odometry that
///                     jumps by a full turn
[[nodiscard]] std::string base_columns(std::string_view table, const std::string& file);

}  // namespace kinecal
