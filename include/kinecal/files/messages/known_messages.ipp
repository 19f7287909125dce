// The messages that kinecal reads and writes, as ROS 1 and ROS 2 define them.
// Source: packages std_msgs, geometry_msgs, nav_msgs, sensor_msgs, tf2_msgs, robot_calibration_msgs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "kinecal/files/bags/bag.hpp"

namespace kinecal::detail {

struct KnownMessage {
  std::string_view type, fields;
  std::string_view md5 = {};  ///< in ROS 1, of those that can be written
};

/// With the fields of ROS 2; known_fields() gives those of ROS 1.
inline constexpr std::array kKnownMessages = {
    KnownMessage{"robot_calibration_msgs/CalibrationData",
                 "sensor_msgs/JointState joint_states\n"
                 "Observation[] observations\n",
                 "a9a1a8b53ea9e13de6dae25608004191"},
    KnownMessage{"robot_calibration_msgs/CaptureConfig",
                 "sensor_msgs/JointState joint_states\n"
                 "string[] features\n",
                 "f347b595aa5cb3d9820e25d6d41f25cd"},
    KnownMessage{"robot_calibration_msgs/Observation",
                 "string sensor_name\n"
                 "geometry_msgs/PointStamped[] features\n"
                 "ExtendedCameraInfo ext_camera_info\n"
                 "sensor_msgs/PointCloud2 cloud\n"
                 "sensor_msgs/Image image\n"},
    KnownMessage{"robot_calibration_msgs/ExtendedCameraInfo",
                 "sensor_msgs/CameraInfo camera_info\n"
                 "CameraParameter[] parameters\n"},
    KnownMessage{"robot_calibration_msgs/CameraParameter",
                 "string name\n"
                 "float64 value\n"},
    KnownMessage{"sensor_msgs/JointState",
                 "std_msgs/Header header\n"
                 "string[] name\n"
                 "float64[] position\n"
                 "float64[] velocity\n"
                 "float64[] effort\n",
                 "3066dcd76a6cfaef579bd0f34173e9fd"},
    KnownMessage{"sensor_msgs/CameraInfo",
                 "std_msgs/Header header\n"
                 "uint32 height\n"
                 "uint32 width\n"
                 "string distortion_model\n"
                 "float64[] d\n"
                 "float64[9] k\n"
                 "float64[9] r\n"
                 "float64[12] p\n"
                 "uint32 binning_x\n"
                 "uint32 binning_y\n"
                 "RegionOfInterest roi\n"},
    KnownMessage{"sensor_msgs/RegionOfInterest",
                 "uint32 x_offset\n"
                 "uint32 y_offset\n"
                 "uint32 height\n"
                 "uint32 width\n"
                 "bool do_rectify\n"},
    KnownMessage{"sensor_msgs/PointCloud2",
                 "std_msgs/Header header\n"
                 "uint32 height\n"
                 "uint32 width\n"
                 "PointField[] fields\n"
                 "bool is_bigendian\n"
                 "uint32 point_step\n"
                 "uint32 row_step\n"
                 "uint8[] data\n"
                 "bool is_dense\n"},
    KnownMessage{"sensor_msgs/PointField",
                 "uint8 INT8=1\n"
                 "uint8 UINT8=2\n"
                 "uint8 INT16=3\n"
                 "uint8 UINT16=4\n"
                 "uint8 INT32=5\n"
                 "uint8 UINT32=6\n"
                 "uint8 FLOAT32=7\n"
                 "uint8 FLOAT64=8\n"
                 "string name\n"
                 "uint32 offset\n"
                 "uint8 datatype\n"
                 "uint32 count\n"},
    KnownMessage{"sensor_msgs/Image",
                 "std_msgs/Header header\n"
                 "uint32 height\n"
                 "uint32 width\n"
                 "string encoding\n"
                 "uint8 is_bigendian\n"
                 "uint32 step\n"
                 "uint8[] data\n"},
    KnownMessage{"sensor_msgs/CompressedImage",
                 "std_msgs/Header header\n"
                 "string format\n"
                 "uint8[] data\n"},
    KnownMessage{"nav_msgs/Odometry",
                 "std_msgs/Header header\n"
                 "string child_frame_id\n"
                 "geometry_msgs/PoseWithCovariance pose\n"
                 "geometry_msgs/TwistWithCovariance twist\n",
                 "cd5e73d190d741a2f92e81eda573aca7"},
    KnownMessage{"sensor_msgs/Imu",
                 "std_msgs/Header header\n"
                 "geometry_msgs/Quaternion orientation\n"
                 "float64[9] orientation_covariance\n"
                 "geometry_msgs/Vector3 angular_velocity\n"
                 "float64[9] angular_velocity_covariance\n"
                 "geometry_msgs/Vector3 linear_acceleration\n"
                 "float64[9] linear_acceleration_covariance\n",
                 "6a62c6daae103f4ff57a132d6f95cec2"},
    KnownMessage{"sensor_msgs/MagneticField",
                 "std_msgs/Header header\n"
                 "geometry_msgs/Vector3 magnetic_field\n"
                 "float64[9] magnetic_field_covariance\n",
                 "2f3b0b43eed0c9501de0fa3ff89a45aa"},
    KnownMessage{"geometry_msgs/Vector3Stamped",
                 "std_msgs/Header header\n"
                 "Vector3 vector\n",
                 "7b324c7325e683bf02a9b14b01090ec7"},
    KnownMessage{"sensor_msgs/LaserScan",
                 "std_msgs/Header header\n"
                 "float32 angle_min\n"
                 "float32 angle_max\n"
                 "float32 angle_increment\n"
                 "float32 time_increment\n"
                 "float32 scan_time\n"
                 "float32 range_min\n"
                 "float32 range_max\n"
                 "float32[] ranges\n"
                 "float32[] intensities\n",
                 "90c7ef2dc6895d81024acba2ac42f369"},
    KnownMessage{"geometry_msgs/PoseStamped",
                 "std_msgs/Header header\n"
                 "Pose pose\n",
                 "d3812c3cbc69362b77dc0b19b345f8f5"},
    KnownMessage{"geometry_msgs/PoseWithCovarianceStamped",
                 "std_msgs/Header header\n"
                 "PoseWithCovariance pose\n"},
    KnownMessage{"geometry_msgs/PoseWithCovariance",
                 "Pose pose\n"
                 "float64[36] covariance\n"},
    KnownMessage{"geometry_msgs/TwistWithCovariance",
                 "Twist twist\n"
                 "float64[36] covariance\n"},
    KnownMessage{"geometry_msgs/Pose",
                 "Point position\n"
                 "Quaternion orientation\n"},
    KnownMessage{"geometry_msgs/Twist",
                 "Vector3 linear\n"
                 "Vector3 angular\n"},
    KnownMessage{"robot_calibration_msgs/GripperLedCommandActionGoal",
                 "std_msgs/Header header\n"
                 "actionlib_msgs/GoalID goal_id\n"
                 "GripperLedCommandGoal goal\n",
                 "a6f43a5345c808a3839fc4ee405e8697"},
    KnownMessage{"robot_calibration_msgs/GripperLedCommandGoal", "uint8 led_code\n"},
    KnownMessage{"actionlib_msgs/GoalID", "time stamp\nstring id\n"},  // of ROS 1
    KnownMessage{"std_msgs/UInt8", "uint8 data\n", "7c8164229e7d2c17eb95e9231617fdee"},
    KnownMessage{"geometry_msgs/PointStamped",
                 "std_msgs/Header header\n"
                 "Point point\n"},
    KnownMessage{"geometry_msgs/Point",
                 "float64 x\n"
                 "float64 y\n"
                 "float64 z\n"},
    KnownMessage{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n",
                 "94810edda583a504dfda3829e70d7eec"},
    KnownMessage{"geometry_msgs/TransformStamped",
                 "std_msgs/Header header\n"
                 "string child_frame_id\n"
                 "Transform transform\n"},
    KnownMessage{"geometry_msgs/Transform",
                 "Vector3 translation\n"
                 "Quaternion rotation\n"},
    KnownMessage{"geometry_msgs/Vector3",
                 "float64 x\n"
                 "float64 y\n"
                 "float64 z\n"},
    KnownMessage{"geometry_msgs/Quaternion",
                 "float64 x\n"
                 "float64 y\n"
                 "float64 z\n"
                 "float64 w\n"},
    KnownMessage{"std_msgs/Header",
                 "builtin_interfaces/Time stamp\n"
                 "string frame_id\n"},
    KnownMessage{"std_msgs/String", "string data\n", "992ce8a1687cec8c8bd883ec73ca41d1"},
    KnownMessage{"builtin_interfaces/Time",
                 "int32 sec\n"
                 "uint32 nanosec\n"},
};

[[nodiscard]] inline const KnownMessage* known_message(std::string_view type) {
  for (const KnownMessage& known : kKnownMessages) {
    if (known.type == type) return &known;
  }
  return nullptr;
}

[[nodiscard]] inline std::string known_fields(const KnownMessage& known, Encoding encoding) {
  if (encoding == Encoding::ros1 && known.type == "std_msgs/Header") {
    return "uint32 seq\ntime stamp\nstring frame_id\n";
  }
  std::string fields(known.fields);
  if (encoding == Encoding::ros1 && known.type == "sensor_msgs/CameraInfo") {
    for (const char* name : {" d\n", " k\n", " r\n", " p\n"}) {
      char& letter = fields[fields.find(name) + 1];
      letter = static_cast<char>(letter - 'a' + 'A');
    }
  }
  return fields;
}

}  // namespace kinecal::detail
