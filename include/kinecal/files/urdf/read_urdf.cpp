// Reads a robot from its URDF: definitions of read_urdf.hpp.
//
// urdfdom decides what a valid URDF is.  Common errors for which urdfdom has no clear message are
// found before it runs and reported with file and line.  The rotation of an origin is computed from
// the roll, pitch and yaw in the file, not from urdfdom's quaternion, which rounds.
// Source: URDF specification, <joint>.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/read_urdf.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <exception>
#include <locale>
#include <map>
#include <mutex>
#include <pugixml.hpp>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/files/yaml/yaml_node.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/text/characters.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/printable.hpp"

namespace kinecal {

namespace detail {
namespace {

// Parses a URDF with urdfdom.  Messages that urdfdom would print become the text of an error,
// because a library never prints.

/// Collects the messages of urdfdom during its lifetime.  console_bridge has one output per
/// process, so a second thread waits.
class UrdfdomMessages : public console_bridge::OutputHandler {
 public:
  UrdfdomMessages()
      : lock_(mutex()),
        previous_(console_bridge::getOutputHandler()),
        previous_level_(console_bridge::getLogLevel()) {
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_ERROR);
    console_bridge::useOutputHandler(this);
  }
  ~UrdfdomMessages() override {
    console_bridge::useOutputHandler(previous_);
    console_bridge::setLogLevel(previous_level_);
  }
  UrdfdomMessages(const UrdfdomMessages&) = delete;
  UrdfdomMessages& operator=(const UrdfdomMessages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel, const char*, int) override {
    all += (all.empty() ? "" : "; ") + text;
  }

  std::string all;

 private:
  [[nodiscard]] static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }

  std::lock_guard<std::mutex> lock_;
  console_bridge::OutputHandler* previous_;
  console_bridge::LogLevel previous_level_;
};

/// Reports duplicate attributes of an element, for which urdfdom has no clear message.
struct DoubleAttributes : pugi::xml_tree_walker {
  DoubleAttributes(const UrdfText& from, Diagnostics& to) : source(from), diagnostics(to) {}

  bool for_each(pugi::xml_node& node) override {
    std::set<std::string> names;
    for (const pugi::xml_attribute attribute : node.attributes()) {
      if (names.insert(attribute.name()).second) continue;
      diagnostics.error(source.place(node), std::string("<") + node.name() +
                                                "> has the attribute '" + attribute.name() +
                                                "' twice; remove one");
    }
    constexpr std::size_t kMost = 20;
    return diagnostics.errors.size() < kMost;
  }

  const UrdfText& source;
  Diagnostics& diagnostics;
};

/// urdfdom's model of the robot.  urdfdom gets the text of the tree with normalized white space in
/// attributes: it would fail on a tab or a line break between two numbers.
/// @throws InputError  with urdfdom's message, if it rejects the text
[[nodiscard]] urdf::ModelInterfaceSharedPtr parse_with_urdfdom(const UrdfText& source) {
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
    DoubleAttributes twice(source, diagnostics);
    source.robot().traverse(twice);
    source.throw_if_errors(diagnostics);
    diagnostics.error(source.place_of_name_in(messages.all), messages.all);
    source.throw_if_errors(diagnostics);
  }
  return model;
}

/// The types of joints by their names in a URDF.
[[nodiscard]] const std::map<std::string, JointType>& urdf_joint_types() {
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

/// Reports the errors of one joint for which urdfdom has no clear message.
void check_urdf_joint(const UrdfText& source, pugi::xml_node joint, Diagnostics& diagnostics) {
  const SourceLocation place = source.place(joint);
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
  for (const std::string& text :
       {name, std::string(joint.child("parent").attribute("link").value()),
        std::string(joint.child("child").attribute("link").value())}) {
    constexpr std::size_t kLongest = 200;  // files are named after it
    if (text.size() > kLongest) {
      diagnostics.error(place, "the name '" + one_line(text.substr(0, kLongest)) + "...' has " +
                                   std::to_string(text.size()) + " characters; at most " +
                                   std::to_string(kLongest) + " are possible");
    }
    if (!has_control_characters(text)) continue;
    diagnostics.error(place, "the name '" + one_line(text) + "' has a control character");
  }
  (void)source.vector(joint.child("origin"), "xyz", diagnostics);
  (void)source.vector(joint.child("origin"), "rpy", diagnostics);
  const bool has_axis =
      type != to_string(JointType::fixed) && type != to_string(JointType::floating);
  if (has_axis) (void)source.vector(joint.child("axis"), "xyz", diagnostics);
}

/// Reports a joint that mimics another through many.  A circle of them is no error: see mimics_a_joint().
void check_urdf_mimic(const UrdfText& source, pugi::xml_node joint, Diagnostics& diagnostics) {
  constexpr std::size_t kMost = 20;
  std::set<std::string> before;
  for (pugi::xml_node next = joint; next.child("mimic");
       next = source.joint(next.child("mimic").attribute("joint").value())) {
    if (!before.insert(next.attribute("name").value()).second) return;
    if (before.size() <= kMost) continue;
    return diagnostics.error(source.place(joint),
                             std::string("joint '") + joint.attribute("name").value() +
                                 "' mimics through more than " + std::to_string(kMost) + " others");
  }
}

/// The robot with these joints, which must be a tree.
/// @throws InputError  if the joints are not a robot, or not a tree
[[nodiscard]] Robot make_urdf_robot(const UrdfText& source, std::vector<Joint> joints) {
  try {
    Robot robot(source.robot().attribute("name").value(), std::move(joints));
    constexpr std::size_t kLongestChain = 500;
    for (const Joint& joint : robot.joints()) {
      if (joints_to_root(robot, joint.child).size() <= kLongestChain) continue;
      throw RobotError("joint '" + joint.name + "' is below more than " +
                       std::to_string(kLongestChain) + " others, which is the most that is read");
    }
    return robot;
  } catch (const RobotError& e) {
    Diagnostics diagnostics;
    diagnostics.error(source.place_of_name_in(e.what()), e.what());
    source.throw_if_errors(diagnostics);
    throw;
  }
}

/// The masses of a robot's links.  Ones that are not numbers from zero are left out: kinematics does not need
/// them.
[[nodiscard]] RobotWeight weight_of(const urdf::ModelInterface& model, const Robot& robot) {
  RobotWeight weight;
  for (const auto& [name, link] : model.links_) {
    if (!link->inertial || !robot.has_link(name)) continue;
    const urdf::Vector3& center = link->inertial->origin.position;
    const LinkMass mass{link->inertial->mass, {center.x, center.y, center.z}};
    if (!(mass.mass > 0.0) || !std::isfinite(mass.mass) || !mass.center.allFinite()) continue;
    weight.links.emplace(name, mass);
  }
  return weight;
}

/// Reports errors of the joints and their connections for which urdfdom has no clear message.
/// (urdfdom would also leak links that form a circle.)
void check_urdf_joints(const UrdfText& source) {
  Diagnostics diagnostics;
  const std::string robot = source.robot().attribute("name").value();
  if (has_control_characters(robot)) {
    diagnostics.error(source.place(source.robot()),
                      "the name '" + one_line(robot) + "' has a control character");
  }
  std::vector<Joint> joints;
  for (pugi::xml_node node : source.robot().children("joint")) {
    check_urdf_joint(source, node, diagnostics);
    check_urdf_mimic(source, node, diagnostics);
    Joint joint;
    joint.name = node.attribute("name").value();
    joint.parent = node.child("parent").attribute("link").value();
    joint.child = node.child("child").attribute("link").value();
    joints.push_back(std::move(joint));
  }
  source.throw_if_errors(diagnostics);
  (void)make_urdf_robot(source, std::move(joints));
}

/// True if a joint mimics one that exists, and not itself in a circle.  urdfdom takes the others,
/// and ROS reads their own positions.
[[nodiscard]] bool mimics_a_joint(const urdf::ModelInterface& model, const urdf::Joint& joint) {
  std::set<std::string> before = {joint.name};
  const urdf::Joint* next = &joint;
  while (next->mimic) {
    const urdf::JointConstSharedPtr mimicked = model.getJoint(next->mimic->joint_name);
    if (!mimicked) return next != &joint;  // that joint has positions of its own
    if (!before.insert(mimicked->name).second) return mimicked->name != joint.name;
    next = mimicked.get();
  }
  return joint.mimic != nullptr;
}

/// The joint with the exact numbers of the file; urdfdom rounds.  What only matters if a chain
/// contains the joint is no error: ignored_urdf.hpp warns of it.
[[nodiscard]] Joint make_urdf_joint(const UrdfText& source, pugi::xml_node node,
                                    const urdf::ModelInterface& model, const urdf::Joint& parsed) {
  Joint joint;
  Diagnostics checked_before;
  joint.name = parsed.name;
  joint.type = urdf_joint_types().at(node.attribute("type").value());
  joint.parent = parsed.parent_link_name;
  joint.child = parsed.child_link_name;
  const pugi::xml_node origin = node.child("origin");
  joint.origin.rotation = rotation_from_rpy(source.vector(origin, "rpy", checked_before));
  joint.origin.translation = source.vector(origin, "xyz", checked_before);
  if (moves(joint.type)) {
    joint.axis = {parsed.axis.x, parsed.axis.y, parsed.axis.z};
    if (joint.axis.isZero(0.0)) joint.type = JointType::planar;  // no chain passes it
  }
  if (mimics_a_joint(model, parsed)) {
    joint.mimic = Mimic{parsed.mimic->joint_name, parsed.mimic->multiplier, parsed.mimic->offset};
  }
  const bool limited = moves(joint.type) && joint.type != JointType::continuous;
  if (limited && parsed.limits) joint.limits = {parsed.limits->lower, parsed.limits->upper};
  return joint;
}

/// The first scalar with a robot; nullptr if there is none.
[[nodiscard]] const YamlNode* robot_scalar(const YamlNode& node) {
  if (node.is_scalar()) return node.text.find("<robot") != std::string::npos ? &node : nullptr;
  for (const YamlNode& item : node.items) {
    if (const YamlNode* found = robot_scalar(item)) return found;
  }
  return nullptr;
}

/// The URDF in what ROS programs print: a value in YAML (`ros2 param dump`, `ros2 topic echo`), or after some words
/// ("String value is: <?xml ..." of `ros2 param get`).  Any other text is returned as it is.
[[nodiscard]] std::string unwrapped_urdf(std::string text) {
  const std::size_t robot = text.find("<robot"), xml = text.find("<?xml"),
                    begin = std::min(robot, xml);
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (robot == std::string::npos || first == std::string::npos || text[first] == '<') return text;
  const std::string_view before = std::string_view(text).substr(first, begin - first);
  if (before.find(':') != std::string_view::npos && !before.starts_with("String value is")) {
    try {
      for (const YamlNode& document : parse_yaml(text, "")) {
        if (const YamlNode* node = robot_scalar(document)) return node->text;
      }
    } catch (const InputError&) {  // not YAML: words before the URDF
    }
  }
  constexpr std::string_view kEnd = "</robot>";
  const std::size_t end = text.rfind(kEnd);
  if (end == std::string::npos || end < begin) return text;
  return text.substr(begin, end + kEnd.size() - begin) + "\n";
}

}  // namespace
}  // namespace detail

Robot parse_urdf(const std::string& text, const std::string& name_for_messages) {
  const detail::UrdfText source(text, name_for_messages);
  detail::check_urdf_joints(source);
  const urdf::ModelInterfaceSharedPtr model = detail::parse_with_urdfdom(source);
  std::vector<Joint> joints;
  for (pugi::xml_node node : source.robot().children("joint")) {
    const urdf::JointConstSharedPtr joint = model->getJoint(node.attribute("name").value());
    joints.push_back(detail::make_urdf_joint(source, node, *model, *joint));
  }
  Robot robot = detail::make_urdf_robot(source, std::move(joints));
  robot.set_weight(detail::weight_of(*model, robot));
  return robot;
}

std::string read_urdf_text(const std::string& path) {
  return detail::unwrapped_urdf(detail::read_text_file(path));
}

Robot read_urdf(const std::string& path) {
  return parse_urdf(read_urdf_text(path), path);
}

}  // namespace kinecal
