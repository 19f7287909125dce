// A robot for kinematics: a tree of links connected by joints, found by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/kinematics/chain_fold.hpp"
#include "kinecal/kinematics/joint.hpp"
#include "kinecal/kinematics/nearest_name.hpp"

namespace kinecal {

/// A robot cannot be used: a name does not exist in it, or links are not connected.
struct RobotError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// A robot: its joints, indexed by name.
class Robot {
 public:
  Robot() = default;

  /// Indexes and checks the joints; axes become unit vectors.
  /// @throws RobotError  if a joint name or child link occurs twice, a joint mimics one that does
  ///                     not exist or itself, or a moving joint has an axis of length zero
  Robot(std::string name, std::vector<Joint> joints)
      : name_(std::move(name)), joints_(std::move(joints)) {
    for (std::size_t i = 0; i < joints_.size(); ++i) add_to_indices(i);
    for (const Joint& joint : joints_) check_mimic(joint);
  }

  [[nodiscard]] const std::string& name() const { return name_; }             ///< of the robot
  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }  ///< in given order

  /// True if the robot has a joint of this name.
  [[nodiscard]] bool has_joint(const std::string& name) const { return by_name_.contains(name); }
  /// True if the robot has a link of this name.
  [[nodiscard]] bool has_link(const std::string& name) const { return links_.contains(name); }

  /// The joint with this name.
  /// @throws RobotError  if it does not exist, with the nearest name
  [[nodiscard]] const Joint& joint(const std::string& name) const {
    const auto it = by_name_.find(name);
    if (it == by_name_.end()) {
      throw RobotError("no joint '" + name + "' in robot '" + name_ + "'" +
                       did_you_mean(name, joint_names()));
    }
    return joints_[it->second];
  }

  /// The joint whose child is this link; nullptr for the root.
  /// @throws RobotError  if the link does not exist, with the nearest name
  [[nodiscard]] const Joint* parent_joint(const std::string& link) const {
    const auto it = links_.find(link);
    if (it == links_.end()) {
      throw RobotError("no link '" + link + "' in robot '" + name_ + "'" +
                       did_you_mean(link, link_names()));
    }
    return it->second < 0 ? nullptr : &joints_[static_cast<std::size_t>(it->second)];
  }

  /// Names of all joints, in their order.
  [[nodiscard]] std::vector<std::string> joint_names() const {
    std::vector<std::string> names;
    for (const Joint& joint : joints_) names.push_back(joint.name);
    return names;
  }

  /// Names of all links, sorted.
  [[nodiscard]] std::vector<std::string> link_names() const {
    std::vector<std::string> names;
    for (const auto& [link, joint] : links_) names.push_back(link);
    return names;
  }

 private:
  void add_to_indices(std::size_t i) {
    Joint& joint = joints_[i];
    if (!by_name_.emplace(joint.name, i).second) {
      throw RobotError("joint '" + joint.name + "' occurs twice");
    }
    links_.try_emplace(joint.parent, -1);
    int& parent_joint = links_.try_emplace(joint.child, -1).first->second;
    if (parent_joint >= 0) {
      throw RobotError("link '" + joint.child + "' is the child of two joints, '" +
                       joints_[static_cast<std::size_t>(parent_joint)].name + "' and '" +
                       joint.name + "'");
    }
    parent_joint = static_cast<int>(i);
    if (!moves(joint.type)) return;
    const double length = std::hypot(joint.axis.x(), joint.axis.y(), joint.axis.z());
    if (!(length > 0.0)) throw RobotError("joint '" + joint.name + "' has an axis of length zero");
    if (std::abs(length - 1.0) > kUnitLength) joint.axis /= length;
  }

  void check_mimic(const Joint& first) const {
    const Joint* joint = &first;
    for (std::size_t steps = 0; joint->mimic; ++steps) {
      if (steps > joints_.size()) {
        throw RobotError("joint '" + first.name + "' mimics itself in a circle");
      }
      if (!has_joint(joint->mimic->joint)) {
        throw RobotError("joint '" + joint->name + "' mimics '" + joint->mimic->joint +
                         "', which does not exist" +
                         did_you_mean(joint->mimic->joint, joint_names()));
      }
      joint = &this->joint(joint->mimic->joint);
    }
  }

  /// A vector divided by its length is this close to length 1.  It is not divided a second time, so
  /// that a joint copied to another robot stays the same, bit for bit.
  static constexpr double kUnitLength = 4.0 * std::numeric_limits<double>::epsilon();

  std::string name_;
  std::vector<Joint> joints_;
  std::map<std::string, std::size_t> by_name_;
  std::map<std::string, int> links_;  ///< link -> index of its parent joint, -1 for the root
};

/// The joint that drives a mimic joint, through all mimic joints in between, with their multipliers
/// and offsets combined.  A joint that does not mimic drives itself.
[[nodiscard]] inline Mimic drive(const Robot& robot, const Joint& joint) {
  return detail::drive_of(robot.joints(), joint);
}

}  // namespace kinecal
