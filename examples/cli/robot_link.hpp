// The robot of a capture session, by its address.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "kinecal/capture/any_robot.hpp"
#include "kinecal/config/capture/capture_config.hpp"

namespace kinecal::cli {

/// How the address of a simulation begins.
inline constexpr std::string_view kSimulated = "simulated:";

/// Who moves a robot.  If a person does, nothing is sent to its controllers, and they need not run.
enum class MovedBy { controllers, person };

/// Topics behind a bridge that capture.yaml does not name.
struct LinkTopics {
  std::string joints = {};  ///< of joint states; empty: /joint_states
  std::string depth = {};   ///< of depth images; empty: finders of points have clouds
};

/// The text of the robot's URDF: of a file, or that behind a bridge.
/// @param urdf     file; empty: none
/// @param address  of the robot
/// @throws InputError       if there is no file, and the address is not of a bridge
/// @throws ConnectionError  if the bridge has none
[[nodiscard]] std::string urdf_of(const std::string& urdf, const std::string& address);

/// Its name, for messages: the file, or /robot_description.
[[nodiscard]] inline std::string urdf_name(const std::string& urdf) {
  return urdf.empty() ? "/robot_description" : urdf;
}

/// Connects to a robot.
///   ws://HOST:PORT    ROS 1 or ROS 2 behind foxglove_bridge
///   pipe:COMMAND      a program that speaks JSON lines: examples/pipe_robot
///   simulated:SCENE   a simulation; SCENE may be empty
/// @param robot  by the URDF
/// @param limits  of the joints' velocities by the URDF, rad/s or m/s
/// @throws InputError       if the address has another form, or the scene is wrong
/// @throws ConnectionError  if the robot cannot be reached
[[nodiscard]] AnyRobot connect(const std::string& address, const CaptureConfig& config,
                               const Robot& robot, const std::map<std::string, double>& limits,
                               MovedBy mover = MovedBy::controllers, const LinkTopics& topics = {});

}  // namespace kinecal::cli
