// The messages that kinecal reads and writes, as ROS 1 and ROS 2 define them.
//
// For bags that do not carry definitions (SQLite of older ROS 2), and for writing bags.  A bag that
// carries its own is read by them.
// Source: packages std_msgs, geometry_msgs, sensor_msgs, robot_calibration_msgs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/io/bags/bag.hpp"

namespace kinecal {
namespace detail {

struct KnownMessage {
  std::string_view type, fields;
  std::string_view md5 = {};  ///< of ROS 1, for those that can be written
};

/// The fields are those of ROS 2; what ROS 1 has otherwise is in known_fields().
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
    KnownMessage{"geometry_msgs/PointStamped",
                 "std_msgs/Header header\n"
                 "Point point\n"},
    KnownMessage{"geometry_msgs/Point",
                 "float64 x\n"
                 "float64 y\n"
                 "float64 z\n"},
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

/// The types that the fields of a message use, in the order in which they are met.
inline void add_dependencies(const std::string& fields, std::string_view owner,
                             std::vector<std::string>& all) {
  for (std::size_t first = 0; first < fields.size();) {
    std::string type = fields.substr(first, fields.find_first_of("[ ", first) - first);
    first = fields.find('\n', first) + 1;
    if (type.find('/') == std::string::npos) {
      type.insert(0, owner.substr(0, owner.find('/') + 1));
    }
    if (known_message(type) == nullptr) continue;  // a number or a text
    if (std::find(all.begin(), all.end(), type) == all.end()) all.push_back(type);
  }
}

}  // namespace detail

/// The .msg text of a message with those of all types that it uses; empty if it is not known.
/// @param type  "package/Type"
[[nodiscard]] inline std::string known_definition(const std::string& type, Encoding encoding) {
  if (detail::known_message(type) == nullptr) return {};
  std::vector<std::string> all = {type};
  std::string text;
  for (std::size_t i = 0; i < all.size(); ++i) {  // grows
    const detail::KnownMessage& known = *detail::known_message(all[i]);
    const std::string fields = detail::known_fields(known, encoding);
    if (i > 0) text += "\n" + std::string(80, '=') + "\nMSG: " + all[i] + "\n";
    text += fields;
    detail::add_dependencies(fields, known.type, all);
  }
  return text;
}

/// The checksum by which ROS 1 knows a message; empty for those that are not written.
[[nodiscard]] inline std::string known_md5(const std::string& type) {
  const detail::KnownMessage* known = detail::known_message(type);
  return known == nullptr ? std::string() : std::string(known->md5);
}

}  // namespace kinecal
