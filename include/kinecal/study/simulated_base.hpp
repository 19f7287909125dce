// A simulated mobile base on two wheels: what its wheels, its odometry and its gyroscope say, and what a laser on it sees, the
// pose that a scan matcher tracks and a wall.
//
// The base differs from what is nominal by factors; wheels turn with noise, and slip.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "kinecal/errors/base_drives.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A base on two wheels, what is wrong with it and how well it is seen.
struct SimulatedBase {
  DifferentialDrive drive{0.0605, 0.37476};     ///< nominal
  double track_width_scale = 1.0;               ///< the true one over the nominal one
  double left_rollout_scale = 1.0;              ///< of the left wheel, true over nominal
  double right_rollout_scale = 1.0;             ///< of the right wheel, true over nominal
  double imu_scale = 1.0;                       ///< true rate over that of the gyroscope
  double imu_bias = 0.0;                        ///< added to the rate, rad/s
  std::array<double, 3> mount{0.23, 0.0, 0.0};  ///< x, y, metres, yaw, radians, of the laser
  double wall = 3.0;                            ///< distance of the wall from the start, metres

  double period = 0.25;            ///< between samples, seconds
  double tracked_position = 2e-3;  ///< standard deviation of the tracked position, metres
  double tracked_angle = 2e-3;     ///< of its angle and of that of the wall, radians
  double wall_distance = 2e-3;     ///< of the distance of the wall, metres
  double rolling = 2e-3;           ///< of a wheel's way of one metre, metres; grows with its root
  double of_runs = 0.0;  ///< of what both wheels roll in a run, a part: the floor, the tyres
  /// Of where the sensor is in a run, metres and radians: how it is tracked, or how the base tilts.
  double mount_of_runs = 0.0;
  double gyro = 5e-4;        ///< of the integral of the gyroscope's rate over a second, radians
  double slip_chance = 0.0;  ///< of a slip in a sample
  double slip = 0.05;        ///< what a wheel turns without moving the base, metres
};

/// A run at constant speed.
struct BaseRun {
  double ahead = 0.0;    ///< m/s
  double turn = 0.0;     ///< rad/s, to the left
  double seconds = 0.0;  ///< how long it takes
};

/// One turn in place in both directions at several speeds, and a metre ahead and back: what base_calibration drives.
[[nodiscard]] std::vector<BaseRun> turns_and_straight_runs();

/// These runs and arcs, which also show where the sensor is on the base.
[[nodiscard]] std::vector<BaseRun> all_runs();

/// A simulated recording.
struct BaseRecording {
  /// Conditions: left_wheel, right_wheel, odom_x, odom_y, odom_yaw, gyro_yaw, time, track_x, track_y, track_yaw, run;
  /// wall_angle and wall_distance, not numbers where the wall is not seen.
  std::vector<Sample> samples;
  std::vector<int> slipped;  ///< samples before which a wheel slipped, from 0
};

/// Drives.  Each run begins in front of the wall.
[[nodiscard]] BaseRecording simulate_base(const SimulatedBase& base, std::span<const BaseRun> runs,
                                          std::uint64_t seed);

}  // namespace kinecal
