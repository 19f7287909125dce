// Definitions of transform_files.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/transform_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "kinecal/files/json/json_text.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/files/xml/xml_edit.ipp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/text/shell_command.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A fixed joint with its calibrated pose.
struct CalibratedMount {
  const Joint* joint;
  Pose<double> parent_T_child;  ///< metres
  bool on_hand = false;         ///< a floating joint moves its parent
  const Joint* floating;        ///< the floating joint of the robot
};

[[nodiscard]] std::string numbers_text(const Vector3<double>& v) {
  return fmt::format("{} {} {}", v.x(), v.y(), v.z());
}

[[nodiscard]] std::string urdf_text_of(const CalibratedMount& mount) {
  const auto quoted = [](const std::string& name) { return xml_attribute_text(name, '"'); };
  return fmt::format(
      "<joint name=\"{}\" type=\"fixed\">\n  <parent link=\"{}\"/>\n  <child link=\"{}\"/>\n"
      "  <origin xyz=\"{}\" rpy=\"{}\"/>\n</joint>\n",
      quoted(mount.joint->name), quoted(mount.joint->parent), quoted(mount.joint->child),
      numbers_text(mount.parent_T_child.translation),
      numbers_text(rpy_from_rotation(mount.parent_T_child.rotation)));
}

/// Arguments of static_transform_publisher.
[[nodiscard]] std::vector<std::string> publisher_arguments(const CalibratedMount& mount) {
  const Vector3<double>& t = mount.parent_T_child.translation;
  const Eigen::Vector4d q = quaternion(mount.parent_T_child.rotation).normalized();
  const auto number = [](double value) { return fmt::format("{}", value); };
  return {"--x",
          number(t.x()),
          "--y",
          number(t.y()),
          "--z",
          number(t.z()),
          "--qx",
          number(q(0)),
          "--qy",
          number(q(1)),
          "--qz",
          number(q(2)),
          "--qw",
          number(q(3)),
          "--frame-id",
          mount.joint->parent,
          "--child-frame-id",
          mount.joint->child};
}

[[nodiscard]] std::string shell_text(const CalibratedMount& mount) {
  ShellCommand command{"ros2", "run", "tf2_ros", "static_transform_publisher"};
  for (const std::string& word : publisher_arguments(mount)) command.add({word});
  return command.str() + "\n";
}

[[nodiscard]] std::string launch_text(const CalibratedMount& mount) {
  std::vector<std::string> arguments = publisher_arguments(mount);
  for (std::string& word : arguments) word = json_text(Json(word));
  return fmt::format(
      "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n"
      "def generate_launch_description():\n"
      "    return LaunchDescription([\n"
      "        Node(\n            package=\"tf2_ros\",\n"
      "            executable=\"static_transform_publisher\",\n            output=\"log\",\n"
      "            arguments=[\n                {}],\n        ),\n    ])\n",
      fmt::join(arguments, ",\n                "));
}

/// The launch file of ROS 1, whose `args` are split as a shell does, after what `$(` begins was substituted.
[[nodiscard]] std::string ros1_launch_text(const CalibratedMount& mount) {
  const Vector3<double>& t = mount.parent_T_child.translation;
  const Eigen::Vector4d q = quaternion(mount.parent_T_child.rotation).normalized();
  std::string args = fmt::format("{} {} {} {}", numbers_text(t), numbers_text(q.head<3>()), q(3),
                                 ShellCommand{mount.joint->parent, mount.joint->child}.str());
  for (std::size_t at = 0; (at = args.find("$(", at)) != std::string::npos;) {
    args.insert(at + 1, "''");  // the quotes end and begin again: the word stays the same
  }
  return fmt::format(
      "<launch>\n  <node pkg=\"tf2_ros\" type=\"static_transform_publisher\" "
      "name=\"kinecal_broadcaster\" args=\"{}\"/>\n</launch>\n",
      xml_attribute_text(args, '"'));
}

[[nodiscard]] std::string matrix_text(const CalibratedMount& mount) {
  std::string text;
  const Pose<double>& pose = mount.parent_T_child;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) text += fmt::format("{} ", pose.rotation(i, j));
    text += fmt::format("{}\n", pose.translation(i));
  }
  return text + "0 0 0 1\n";
}

[[nodiscard]] std::string easy_handeye_text(const CalibratedMount& mount) {
  const Eigen::Vector4d q = quaternion(mount.parent_T_child.rotation).normalized();
  const Vector3<double>& t = mount.parent_T_child.translation;
  return fmt::format(
      "parameters:\n  eye_on_hand: {}\n  robot_base_frame: {}\n  robot_effector_frame: {}\n"
      "  tracking_base_frame: {}\n"
      "transformation:\n  x: {}\n  y: {}\n  z: {}\n  qx: {}\n  qy: {}\n  qz: {}\n  qw: {}\n",
      mount.on_hand, name_to_yaml(mount.floating->parent), name_to_yaml(mount.floating->child),
      name_to_yaml(mount.joint->child), number_to_yaml(t.x()), number_to_yaml(t.y()),
      number_to_yaml(t.z()), number_to_yaml(q(0)), number_to_yaml(q(1)), number_to_yaml(q(2)),
      number_to_yaml(q(3)));
}

/// The calibration of easy_handeye2.
[[nodiscard]] std::string easy_handeye2_text(const CalibratedMount& mount,
                                             const std::string& name) {
  const Eigen::Vector4d q = quaternion(mount.parent_T_child.rotation).normalized();
  const Vector3<double>& t = mount.parent_T_child.translation;
  return fmt::format(
      "parameters:\n  name: {}\n  calibration_type: {}\n  robot_base_frame: {}\n"
      "  robot_effector_frame: {}\n  tracking_base_frame: {}\n  tracking_marker_frame: ''\n"
      "  freehand_robot_movement: true\n"
      "transform:\n  translation:\n    x: {}\n    y: {}\n    z: {}\n"
      "  rotation:\n    x: {}\n    y: {}\n    z: {}\n    w: {}\n",
      name_to_yaml(name), mount.on_hand ? "eye_in_hand" : "eye_on_base",
      name_to_yaml(mount.floating->parent), name_to_yaml(mount.floating->child),
      name_to_yaml(mount.joint->child), number_to_yaml(t.x()), number_to_yaml(t.y()),
      number_to_yaml(t.z()), number_to_yaml(q(0)), number_to_yaml(q(1)), number_to_yaml(q(2)),
      number_to_yaml(q(3)));
}

}  // namespace
}  // namespace detail

std::vector<OutputFile> transform_files(const Robot& robot, const ParameterTable& table,
                                        std::span<const Sample> samples) {
  const auto is_measured = [&](const Joint& joint) {
    return joint.type == JointType::floating &&
           std::any_of(samples.begin(), samples.end(),
                       [&](const Sample& sample) { return sample.poses.contains(joint.name); });
  };
  const auto floating = std::find_if(robot.joints().begin(), robot.joints().end(), is_measured);
  if (floating == robot.joints().end()) return {};
  std::vector<OutputFile> files;
  for (const JointPatch& patch : joint_patches(robot, table)) {
    const Joint& joint = robot.joint(patch.joint);
    if (joint.type != JointType::fixed) continue;
    const std::vector<const Joint*> above = joints_to_root(robot, joint.parent);
    const bool on_hand = std::any_of(above.begin(), above.end(),
                                     [&](const Joint* one) { return one->name == floating->name; });
    const detail::CalibratedMount mount{&joint, joint.origin * patch.correction, on_hand,
                                        &*floating};
    std::string stem = joint.name;
    std::replace(stem.begin(), stem.end(), '/', '_');
    files.push_back({stem + ".xml", detail::urdf_text_of(mount)});
    files.push_back({stem + ".sh", detail::shell_text(mount)});
    files.push_back({stem + ".launch.py", detail::launch_text(mount)});
    files.push_back({stem + ".launch", detail::ros1_launch_text(mount)});
    files.push_back({stem + ".txt", detail::matrix_text(mount)});
    files.push_back({stem + ".easy_handeye.yaml", detail::easy_handeye_text(mount)});
    files.push_back({stem + ".calib", detail::easy_handeye2_text(mount, stem)});
  }
  return files;
}

}  // namespace kinecal
