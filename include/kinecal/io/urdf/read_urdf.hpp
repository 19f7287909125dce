// A robot from its URDF, read by urdfdom.
//
// urdfdom decides what a valid URDF is.  Around it: the mistakes people make are found first and
// told with file and line; what urdfdom would print becomes part of the error; and an origin's
// rotation is taken from the file's own roll, pitch and yaw, not by way of a quaternion, so that
// nothing is lost.
// Source: URDF specification, <joint>.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <urdf_parser/urdf_parser.h>

#include <cerrno>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <locale>
#include <map>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "kinecal/geometry/rpy.hpp"
#include "kinecal/io/urdf/urdf_text.hpp"
#include "kinecal/io/urdf/urdfdom_messages.hpp"
#include "kinecal/kinematics/chain.hpp"

namespace kinecal {

namespace detail {

/// The URDF's words for the types of joints.
[[nodiscard]] inline const std::map<std::string, JointType>& urdf_joint_types() {
  static const std::map<std::string, JointType> types = [] {
    std::map<std::string, JointType> names;
    for (JointType type : {JointType::fixed, JointType::revolute, JointType::continuous,
                           JointType::prismatic, JointType::floating, JointType::planar}) {
      names.emplace(to_string(type), type);
    }
    return names;
  }();
  return types;
}

/// Finds the mistakes of one joint for which urdfdom has no clear message.
inline void check_urdf_joint(const UrdfText& source, pugi::xml_node joint,
                             Diagnostics& diagnostics) {
  const Place place = source.place(joint);
  const std::string name = joint.attribute("name").value(), type = joint.attribute("type").value();
  if (name.empty()) return diagnostics.error(place, "a joint has no name");
  if (const pugi::xml_node first = source.joint(name); first != joint) {
    diagnostics.error(place, "joint '" + name + "' occurs twice, first in line " +
                                 std::to_string(source.place(first).line));
  }
  if (!urdf_joint_types().contains(type)) {
    std::vector<std::string> known;
    for (const auto& [known_type, value] : urdf_joint_types()) known.push_back(known_type);
    diagnostics.error(
        place, "joint '" + name + "' has " +
                   (type.empty() ? "no type"
                                 : "the unknown type '" + type + "'" + did_you_mean(type, known)));
  }
  for (const char* end : {"parent", "child"}) {
    if (joint.child(end).attribute("link").empty()) {
      diagnostics.error(place, "joint '" + name + "' has no <" + end + " link=\"...\"/>");
    }
  }
  (void)source.vector(joint.child("origin"), "xyz", diagnostics);
  (void)source.vector(joint.child("origin"), "rpy", diagnostics);
  (void)source.vector(joint.child("axis"), "xyz", diagnostics);
}

/// The robot made of these joints, a tree.
/// @throws InputError  where the robot or its tree would refuse them
[[nodiscard]] inline Robot make_urdf_robot(const UrdfText& source, std::vector<Joint> joints) {
  try {
    Robot robot(source.robot().attribute("name").value(), std::move(joints));
    for (const Joint& joint : robot.joints()) (void)joints_to_root(robot, joint.child);
    return robot;
  } catch (const RobotError& e) {
    Diagnostics diagnostics;
    diagnostics.error(source.place_of_name_in(e.what()), e.what());
    source.throw_if_errors(diagnostics);
    throw;
  }
}

/// Finds the mistakes of the joints, each for itself and how they hang together, for which urdfdom
/// has no clear message.  (Links in a circle it would also leak.)
inline void check_urdf_joints(const UrdfText& source) {
  Diagnostics diagnostics;
  std::vector<Joint> joints;
  for (pugi::xml_node node : source.robot().children("joint")) {
    check_urdf_joint(source, node, diagnostics);
    Joint joint;
    joint.name = node.attribute("name").value();
    joint.parent = node.child("parent").attribute("link").value();
    joint.child = node.child("child").attribute("link").value();
    joints.push_back(std::move(joint));
  }
  source.throw_if_errors(diagnostics);
  (void)make_urdf_robot(source, std::move(joints));
}

/// urdfdom's model of the robot.  It is given the tree as text again, with the white space of
/// attributes in order: a tab or line break between two numbers would make it fail.
[[nodiscard]] inline urdf::ModelInterfaceSharedPtr parse_with_urdfdom(const UrdfText& source) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  source.robot().print(text, "", pugi::format_raw);
  UrdfdomMessages messages;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(text.str());
  } catch (const std::exception& e) {
    messages.all += (messages.all.empty() ? "" : "; ") + std::string(e.what());
  }
  if (!model) {
    Diagnostics diagnostics;
    diagnostics.error(source.place_of_name_in(messages.all), messages.all);
    source.throw_if_errors(diagnostics);
  }
  return model;
}

[[nodiscard]] inline Joint make_urdf_joint(const UrdfText& source, pugi::xml_node node,
                                           const urdf::Joint& parsed) {
  Joint joint;
  Diagnostics checked_before;
  joint.name = parsed.name;
  joint.type = urdf_joint_types().at(node.attribute("type").value());
  joint.parent = parsed.parent_link_name;
  joint.child = parsed.child_link_name;
  const pugi::xml_node origin = node.child("origin");
  joint.origin.rotation = rotation_from_rpy(source.vector(origin, "rpy", checked_before));
  joint.origin.translation = source.vector(origin, "xyz", checked_before);
  if (moves(joint.type)) joint.axis = {parsed.axis.x, parsed.axis.y, parsed.axis.z};
  if (parsed.mimic) {
    joint.mimic = Mimic{parsed.mimic->joint_name, parsed.mimic->multiplier, parsed.mimic->offset};
  }
  const bool limited = moves(joint.type) && joint.type != JointType::continuous;
  if (limited && parsed.limits) joint.limits = {parsed.limits->lower, parsed.limits->upper};
  return joint;
}

}  // namespace detail

/// The robot that a URDF describes, its joints in the order of the text.
/// @param text               the URDF, UTF-8
/// @param name_for_messages  what to call the text in messages: its file
/// @throws InputError  "file:line: message" if the text is not a URDF or its joints are no tree
[[nodiscard]] inline Robot parse_urdf(const std::string& text,
                                      const std::string& name_for_messages) {
  const UrdfText source(text, name_for_messages);
  detail::check_urdf_joints(source);
  const urdf::ModelInterfaceSharedPtr model = detail::parse_with_urdfdom(source);
  std::vector<Joint> joints;
  for (pugi::xml_node node : source.robot().children("joint")) {
    const urdf::JointConstSharedPtr joint = model->getJoint(node.attribute("name").value());
    joints.push_back(detail::make_urdf_joint(source, node, *joint));
  }
  return detail::make_urdf_robot(source, std::move(joints));
}

/// The text of a URDF, byte for byte.
/// @throws InputError  if it cannot be read
[[nodiscard]] inline std::string read_urdf_text(const std::string& path) {
  std::error_code no_such_file;  // told below
  if (std::filesystem::is_directory(path, no_such_file)) {
    throw InputError(path + ": is a folder, not a URDF");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw InputError(path + ": cannot be read: " + std::generic_category().message(errno));
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The robot that a URDF file describes.
/// @throws InputError  if the file cannot be read, and as parse_urdf()
[[nodiscard]] inline Robot read_urdf(const std::string& path) {
  return parse_urdf(read_urdf_text(path), path);
}

}  // namespace kinecal
