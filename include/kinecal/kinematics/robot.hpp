// A robot for kinematics: a tree of links connected by joints, found by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/kinematics/joint.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

/// A robot cannot be used: a name does not exist in it, or links are not connected.
struct RobotError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// The mass of a link.
struct LinkMass {
  double mass = 0.0;                                 ///< kg
  Vector3<double> center = Vector3<double>::Zero();  ///< (3) of mass, metres, in the link
};

/// What gravity does to a robot.
struct RobotWeight {
  std::map<std::string, LinkMass> links;        ///< masses by link; empty: unknown
  Vector3<double> gravity{0.0, 0.0, -9.80665};  ///< (3) m/s^2, in the root link
  std::string payload;  ///< link that carries the condition `payload` of a sample, kg; empty: none
};

/// A robot: its joints, indexed by name.
class Robot {
 public:
  Robot() = default;

  /// Indexes and checks the joints; axes become unit vectors.
  /// @throws RobotError  if a joint name or child link occurs twice, a joint mimics one that does
  ///                     not exist or itself, or a moving joint has an axis of length zero
  Robot(std::string name, std::vector<Joint> joints);

  [[nodiscard]] const std::string& name() const { return name_; }             ///< of the robot
  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }  ///< in given order

  /// Masses of the links, and gravity.
  [[nodiscard]] const RobotWeight& weight() const { return weight_; }
  /// @throws RobotError  if a mass or the payload is of a link that does not exist, or not a number
  void set_weight(RobotWeight weight);

  /// True if the robot has a joint of this name.
  [[nodiscard]] bool has_joint(const std::string& name) const { return by_name_.contains(name); }
  /// True if the robot has a link of this name.
  [[nodiscard]] bool has_link(const std::string& name) const { return links_.contains(name); }

  /// The joint with this name.
  /// @throws RobotError  if it does not exist, with the nearest name
  [[nodiscard]] const Joint& joint(const std::string& name) const;

  /// The joint whose child is this link; nullptr for the root.
  /// @throws RobotError  if the link does not exist, with the nearest name
  [[nodiscard]] const Joint* parent_joint(const std::string& link) const;

  /// Names of all joints, in their order.
  [[nodiscard]] std::vector<std::string> joint_names() const;

  /// Names of all links, sorted.
  [[nodiscard]] std::vector<std::string> link_names() const;

 private:
  void add_to_indices(std::size_t i);

  void check_mimic(const Joint& first) const;

  std::string name_;
  std::vector<Joint> joints_;
  RobotWeight weight_;
  std::map<std::string, std::size_t> by_name_;
  std::map<std::string, int> links_;  ///< link -> index of its parent joint, -1 for the root
};

/// The joint that drives a mimic joint, through all mimic joints in between, with their multipliers
/// and offsets combined.  A joint that does not mimic drives itself.
[[nodiscard]] Mimic drive(const Robot& robot, const Joint& joint);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/kinematics/robot.ipp"
#endif
