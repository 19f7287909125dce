// A mobile base with ROS 1 or ROS 2 behind a Foxglove bridge: what it reports and sees is recorded; asked for it, it is
// driven, in turns in place and straight runs in front of a wall, as base_calibration of robot_calibration does.
//
//   RosBase base({"ws://fetch:8765"}, {}, record);     // record: into a bag
//   const std::string why = drive_base(base, {}, [] { return false; }, say);
//
// A base that is driven gets zero velocity when a run ends, when it is interrupted, when its odometry falls silent, when scans
// do during a run ahead, and when anything is thrown.  A connection that is lost takes no command: then the base's own driver must stop it.
// Source: robot_calibration, base_calibration.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/files/messages/value.hpp"
#include "kinecal/robots/socket/web_socket.hpp"

namespace kinecal {

/// Topics of a base.  Those that the bridge does not offer are silent.
struct BaseTopics {
  std::string odom = "/odom";                                ///< nav_msgs/Odometry
  std::string commands = "/cmd_vel";                         ///< geometry_msgs/Twist
  std::vector<std::string> scans = {"/base_scan", "/scan"};  ///< sensor_msgs/LaserScan
  std::vector<std::string> others = {
      "/imu",          "/imu1/imu",  "/imu/data",  ///< any type: recorded
      "/joint_states", "/tf_static", "/robot_description"};
};

/// Receives each message.
/// @param time  of arrival, nanoseconds since 1970
using RecordMessage = std::function<void(const std::string& topic, const std::string& type,
                                         std::int64_t time, const MessageFields& message)>;

/// A connection to a base.
class RosBase {
 public:
  /// A pose of the odometry, and when it came.
  struct Odometry {
    double x = 0.0, y = 0.0, yaw = 0.0;  ///< metres; radians, without jumps
    std::chrono::steady_clock::time_point arrival;
  };
  /// What scans have ahead, within half a radian of the base's x axis, and when the oldest of them came.
  struct Ahead {
    double nearest = 0.0;  ///< metres from the scanner; infinite if there is nothing
    std::chrono::steady_clock::time_point arrival;
  };

  /// @throws ConnectionError        naming the address, if no bridge answers there, or a topic has another type
  /// @throws std::invalid_argument  if the address does not have the form ws://host:port
  RosBase(const BridgeOptions& options, const BaseTopics& topics, RecordMessage record);
  RosBase(RosBase&&) noexcept;
  RosBase& operator=(RosBase&&) noexcept;
  ~RosBase();

  /// Records what comes in a time.
  /// @throws ConnectionError  if the connection has ended
  void record(std::chrono::milliseconds time);

  /// Messages so far, by topic.
  [[nodiscard]] const std::map<std::string, int>& received() const;
  [[nodiscard]] const std::optional<Odometry>& odometry() const;  ///< the newest
  [[nodiscard]] const std::optional<Ahead>& ahead() const;        ///< the newest
  /// Why nothing is known of what is ahead, such as a scanner whose mount is not in /tf_static.
  [[nodiscard]] std::string why_nothing_ahead() const;
  /// Why there is no odometry.
  [[nodiscard]] std::string why_no_odometry() const;

  /// Commands a velocity.
  /// @param ahead  m/s
  /// @param turn   rad/s, to the left
  /// @throws ConnectionError  if the connection has ended, or the bridge takes no messages
  void command(double ahead, double turn);

  /// Commands zero several times; does not throw.
  void stop() noexcept;

 private:
  class State;
  std::unique_ptr<State> state_;
};

/// How a base is driven.
struct BaseDriving {
  double turn = 1.5;                     ///< rad/s, at most; turns are also made at a third of it
  double speed = 0.2;                    ///< m/s, at most; runs are also made at half of it
  double distance = 1.0;                 ///< of a straight run, metres
  double turn_acceleration = 2.0;        ///< rad/s^2
  double acceleration = 0.5;             ///< m/s^2
  double least_range = 0.4;              ///< metres: the base does not go nearer to what is ahead
  std::chrono::milliseconds rest{1200};  ///< between runs
  /// Of odometry, or of scans during a run ahead: the base is stopped.
  std::chrono::milliseconds silence{500};
};

/// Drives a full turn in both directions at two speeds; and, if a scanner with a known mount shows a wall ahead and room before
/// it, a straight run ahead and back at two speeds.  Records meanwhile.
/// @param is_interrupted  asked all the time
/// @param say             receives what is being done, one line each
/// @returns  why it ended early; empty if it did not
/// @throws std::invalid_argument  if a speed or a distance is not positive
/// @throws ConnectionError        if the connection has ended: the base may be moving
[[nodiscard]] std::string drive_base(RosBase& base, const BaseDriving& driving,
                                     const std::function<bool()>& is_interrupted,
                                     const std::function<void(const std::string&)>& say);

}  // namespace kinecal
