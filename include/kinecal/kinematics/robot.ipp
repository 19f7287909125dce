// Definitions of robot.hpp: names and their checks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <set>

#include "kinecal/kinematics/chain_fold.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {

/// A normalized vector has length 1 within this.  It is not normalized again, so a joint copied to
/// another robot stays the same, bit for bit.
inline constexpr double kUnitLength = 4.0 * std::numeric_limits<double>::epsilon();

/// Adds each link under its other spelling: /tool as tool, and tool as /tool.
/// @throws RobotError  if two links differ only by the slash
inline void add_other_spellings(std::map<std::string, int>& links) {
  std::map<std::string, int> others;
  for (const auto& [link, joint] : links) {
    const std::string_view plain = plain_frame(link);
    std::string other = plain.size() < link.size() ? std::string(plain) : "/" + link;
    if (links.contains(other)) {
      throw RobotError("links '" + link + "' and '" + other +
                       "' differ only by the leading slash, which names of frames lose in ROS; "
                       "rename one of them");
    }
    if (link != "/") others.emplace(std::move(other), joint);
  }
  links.merge(others);
}

}  // namespace detail

KINECAL_INLINE Robot::Robot(std::string name, std::vector<Joint> joints)
    : name_(std::move(name)), joints_(std::move(joints)) {
  for (std::size_t i = 0; i < joints_.size(); ++i) add_to_indices(i);
  detail::add_other_spellings(links_);
  for (const Joint& joint : joints_) check_mimic(joint);
}

KINECAL_INLINE void Robot::set_weight(RobotWeight weight) {
  const auto check = [&](const std::string& link, bool is_number) {
    if (!has_link(link)) {
      throw RobotError("no link '" + link + "' in robot '" + name_ + "', whose weight is given" +
                       did_you_mean(link, link_names()));
    }
    if (!is_number) throw RobotError("the mass of link '" + link + "' is not a number from 0");
  };
  for (const auto& [link, of] : weight.links) {
    check(link, of.mass >= 0.0 && std::isfinite(of.mass) && of.center.allFinite());
  }
  if (!weight.payload.empty()) check(weight.payload, true);
  if (!weight.gravity.allFinite()) throw RobotError("gravity is not a number");
  weight_ = std::move(weight);
}

KINECAL_INLINE const Joint& Robot::joint(const std::string& name) const {
  const auto it = by_name_.find(name);
  if (it == by_name_.end()) {
    throw RobotError("no joint '" + name + "' in robot '" + name_ + "'" +
                     did_you_mean(name, joint_names()));
  }
  return joints_[it->second];
}

KINECAL_INLINE const Joint* Robot::parent_joint(const std::string& link) const {
  const auto it = links_.find(link);
  if (it == links_.end()) {
    throw RobotError("no link '" + link + "' in robot '" + name_ + "'" +
                     did_you_mean(link, link_names()));
  }
  return it->second < 0 ? nullptr : &joints_[static_cast<std::size_t>(it->second)];
}

KINECAL_INLINE std::vector<std::string> Robot::joint_names() const {
  std::vector<std::string> names;
  for (const Joint& joint : joints_) names.push_back(joint.name);
  return names;
}

KINECAL_INLINE std::vector<std::string> Robot::link_names() const {
  std::set<std::string> names;
  for (const Joint& joint : joints_) {
    names.insert(joint.parent);
    names.insert(joint.child);
  }
  return {names.begin(), names.end()};
}

KINECAL_INLINE void Robot::add_to_indices(std::size_t i) {
  Joint& joint = joints_[i];
  if (!by_name_.emplace(joint.name, i).second) {
    throw RobotError("joint '" + joint.name + "' occurs twice");
  }
  links_.try_emplace(joint.parent, -1);
  int& parent_joint = links_.try_emplace(joint.child, -1).first->second;
  if (parent_joint >= 0) {
    throw RobotError("link '" + joint.child + "' is the child of two joints, '" +
                     joints_[static_cast<std::size_t>(parent_joint)].name + "' and '" + joint.name +
                     "'");
  }
  parent_joint = static_cast<int>(i);
  if (!moves(joint.type)) return;
  const double length = std::hypot(joint.axis.x(), joint.axis.y(), joint.axis.z());
  if (!(length > 0.0)) throw RobotError("joint '" + joint.name + "' has an axis of length zero");
  if (std::abs(length - 1.0) > detail::kUnitLength) joint.axis /= length;
}

KINECAL_INLINE void Robot::check_mimic(const Joint& first) const {
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

KINECAL_INLINE Mimic drive(const Robot& robot, const Joint& joint) {
  return detail::drive_of(robot.joints(), joint);
}

}  // namespace kinecal
