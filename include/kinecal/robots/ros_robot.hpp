// A robot with ROS 1 or ROS 2 behind a Foxglove bridge: its arm, cameras and lamps.
//
//   RosBridge bridge({"ws://fetch:8765"});
//   RosArm arm(bridge, {.controllers = {{"/arm_controller/follow_joint_trajectory", {"elbow"}}}});
//   RosCamera camera(bridge, {.cloud = "/head_camera/depth_registered/points"});
//
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/robots/socket/web_socket.hpp"

namespace kinecal {

namespace detail {
class RosRobot;
class RosAction;
class ViewStreams;
}  // namespace detail

/// A connection to a bridge, and the joint states received over it.
class RosBridge {
 public:
  /// @param joint_states  topic of sensor_msgs/JointState; several nodes may publish on it
  /// @throws ConnectionError        naming the address, if no bridge answers there, or the topic
  ///                                has another type
  /// @throws std::invalid_argument  if the address does not have the form ws://host:port
  explicit RosBridge(const BridgeOptions& options,
                     const std::string& joint_states = "/joint_states");
  RosBridge(RosBridge&&) noexcept;
  RosBridge& operator=(RosBridge&&) noexcept;
  ~RosBridge();

  /// For the classes below.
  [[nodiscard]] detail::RosRobot& robot() { return *robot_; }

 private:
  std::unique_ptr<detail::RosRobot> robot_;
};

/// The URDF behind a bridge: the parameter /robot_description of ROS 1, or what the topic of that name has.
/// @throws ConnectionError        if there is none in time, or no bridge answers
/// @throws PoseError              if what comes is not a text
/// @throws std::invalid_argument  if the address does not have the form ws://host:port
[[nodiscard]] std::string robot_description(const BridgeOptions& options);

/// A controller that moves joints by control_msgs/FollowJointTrajectory.
struct JointController {
  std::string action;               ///< "/arm_controller/follow_joint_trajectory"
  std::vector<std::string> joints;  ///< that it moves
};

/// Options for moving an arm.
struct RosArmOptions {
  std::vector<JointController> controllers = {};
  std::vector<std::string> measured = {};  ///< needed joints that no controller moves
  double duration = 2.0;                   ///< of a motion at least, seconds; as in capture.yaml
  double speed = 0.7;  ///< largest of a joint, rad/s or m/s, at velocity factor 1
  std::map<std::string, double> speeds = {};  ///< the same, for joints that differ
};

/// Joints moved by controllers.
class RosArm {
 public:
  /// @param bridge  must outlive this
  /// @throws ConnectionError  if the bridge does not offer the controllers' actions
  RosArm(RosBridge& bridge, const RosArmOptions& options);
  RosArm(RosArm&&) noexcept;
  RosArm& operator=(RosArm&&) noexcept;
  ~RosArm();

  /// Starts a move; joints without a controller stay.  A controller's other joints are held in
  /// place.
  /// @throws PoseError  if no controller moves any of these joints, or one rejects the goal
  void move(const JointTarget& target);

  /// All joint positions.  The stamp is the oldest of the controllers' joints.
  /// @throws SilenceError     if they do not arrive in time, with topic, newest stamp and reason
  /// @throws PoseError        if a controller has given up since the last motion started
  /// @throws ConnectionError  if the bridge has withdrawn their topic
  [[nodiscard]] MeasuredJoints next_joints(Stamp after);

 private:
  detail::RosRobot* robot_;
  RosArmOptions options_;
  std::vector<detail::RosAction> actions_;  ///< of the controllers
};
static_assert(RobotArm<RosArm>);

/// Topics of a camera; empty: none.
struct RosCameraOptions {
  std::string image = {};  ///< sensor_msgs/Image or CompressedImage
  std::string depth = {};  ///< the same in depth, registered to the image; needs camera_info
  /// sensor_msgs/PointCloud2, whose colour replaces a missing image, or LaserScan.
  std::string cloud = {};
  std::string camera_info = {};  ///< sensor_msgs/CameraInfo
};

/// A camera; joins its streams by their stamps.
class RosCamera {
 public:
  /// @param bridge  must outlive this
  /// @throws std::invalid_argument  if there is no image, no depth and no cloud
  RosCamera(RosBridge& bridge, const RosCameraOptions& options);
  RosCamera(RosCamera&&) noexcept;
  RosCamera& operator=(RosCamera&&) noexcept;
  ~RosCamera();

  /// @throws SilenceError     if none arrives in time, with topic, newest stamp and reason
  /// @throws PoseError        if its stamps use another clock than the joint states, or those of
  ///                          its topics never match
  /// @throws ConnectionError  if the bridge has withdrawn a topic
  [[nodiscard]] View next_view(Stamp after);

 private:
  std::unique_ptr<detail::ViewStreams> streams_;
};
static_assert(RobotCamera<RosCamera>);

/// LEDs switched by an action: robot_calibration_msgs/GripperLedCommand.
class RosLamp {
 public:
  /// @param bridge  must outlive this
  /// @param action  "/gripper_controller/led_action"
  /// @throws ConnectionError  if the bridge does not offer it
  RosLamp(RosBridge& bridge, const std::string& action);
  RosLamp(RosLamp&&) noexcept;
  RosLamp& operator=(RosLamp&&) noexcept;
  ~RosLamp();

  /// @return  stamp of the first joint state after the robot reported success
  /// @throws PoseError  if the robot rejects it or does not report success in time
  [[nodiscard]] Stamp light(int code);

 private:
  detail::RosRobot* robot_;
  std::unique_ptr<detail::RosAction> action_;
};
static_assert(RobotLamp<RosLamp>);

}  // namespace kinecal
