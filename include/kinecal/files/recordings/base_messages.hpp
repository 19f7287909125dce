// The drive of a mobile base from a bag: odometry, a gyroscope, wheels, and what shows how it really moved, a wall in the scans
// of a laser or a tracked pose.
//
//   nav_msgs/Odometry                 odom_x odom_y odom_yaw; the angle does not jump at a full turn
//   sensor_msgs/Imu                   gyro_yaw: the integral of its rate about z
//   sensor_msgs/JointState            wheels and a steering angle, by the names of joints: see base_conditions.hpp; of four
//                                     wheels also left_wheel right_wheel, the mean of each side
//   sensor_msgs/LaserScan             wall_angle wall_distance, not numbers where it shows no wall
//   geometry_msgs/PoseStamped, PoseWithCovarianceStamped   track_x track_y track_yaw
//
// There is a sample at each scan, or at each tracked pose if there are no scans, with the others interpolated to its stamp; of
// samples that stand still or are near to each other, one.  A run begins where the base starts to move: condition `run`.  Of
// several topics of a type, the one with upstream's name counts (odom, imu, base_scan), else that with most messages; both types
// of poses are one.  Messages that have no numbers are left out; a run ends where the gyroscope is silent for half a second.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// True for a topic that shows how a base moved: scans, a tracked pose.
[[nodiscard]] bool shows_base(const BagTopic& topic);

/// The drive of a base, from a bag.
struct BaseDrive {
  std::vector<Sample> samples;
  std::string base_frame;    ///< of the odometry; empty: it says none
  std::string sensor_frame;  ///< of the scans; empty: there are none
  std::string urdf;          ///< the last /robot_description; empty: there is none
};

/// Reads a drive; no samples if the bag has no odometry, gyroscope or wheels, or nothing to compare them with: that is an
/// error.
/// @param diagnostics  receives errors; a doubt if clocks differ or the gyroscope turns against the odometry; notes of scans
///                     without a wall
[[nodiscard]] BaseDrive read_base_drive(const std::string& path, Diagnostics& diagnostics);

}  // namespace kinecal
