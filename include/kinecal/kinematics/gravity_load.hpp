// What gravity does to the joints of a robot in a pose.
//
//   load of joint j = sum over masses m of  m g . dp/dq_j        (virtual work; g: gravity, p: place)
//
// Source: Siciliano et al., Robotics: Modelling, Planning and Control, 7.1.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <utility>

#include "kinecal/kinematics/joint_state.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// The loads of a robot's joints in a pose.
class GravityLoads {
 public:
  /// @param robot        must outlive this
  /// @param position_of  callable: name of a joint that does not mimic -> its position, radians or
  ///                     metres
  template <class PositionOf>
  GravityLoads(const Robot& robot, PositionOf&& position_of) : robot_(robot) {
    for (const Joint& joint : robot.joints()) {
      if (!moves(joint.type)) continue;
      const Mimic by = drive(robot, joint);
      drives_.emplace(joint.name, Drive{by, by.multiplier * position_of(by.joint) + by.offset});
    }
  }

  /// Adds a point mass to a link.
  /// @param center  (3) metres, in the link
  /// @param mass    kg
  void add(const std::string& link, const Vector3<double>& center, double mass) {
    const Vector3<double> force = mass * robot_.weight().gravity;
    const Vector3<double> place = pose(link) * center;
    for (const Joint* joint = robot_.parent_joint(link); joint != nullptr;
         joint = robot_.parent_joint(joint->parent)) {
      if (!moves(joint->type)) continue;
      const Pose<double> at = pose(joint->parent) * joint->origin;
      const Vector3<double> axis = at.rotation * joint->axis;
      const Vector3<double> velocity =
          turns(joint->type) ? Vector3<double>(axis.cross(place - at.translation)) : axis;
      const Mimic& by = drives_.at(joint->name).by;
      loads_[by.joint] += by.multiplier * force.dot(velocity);
    }
  }
  /// Adds the masses of all links.
  void add_links() {
    for (const auto& [link, of] : robot_.weight().links) add(link, of.center, of.mass);
  }

  /// The load of a joint that does not mimic: torque about its axis, N m, or force along it, N.
  [[nodiscard]] double of(const std::string& joint) const {
    const auto known = loads_.find(joint);
    return known == loads_.end() ? 0.0 : known->second;
  }

 private:
  struct Drive {
    Mimic by;
    double position;
  };

  /// The pose of a link in the root link.
  const Pose<double>& pose(const std::string& link) {
    if (const auto known = poses_.find(link); known != poses_.end()) return known->second;
    Pose<double> of_link;
    if (const Joint* joint = robot_.parent_joint(link); joint != nullptr) {
      of_link = pose(joint->parent) * joint->origin;
      if (moves(joint->type)) {
        of_link = of_link * joint_pose(joint->type, joint->axis,
                                       make_joint_state(drives_.at(joint->name).position));
      }
    }
    return poses_.emplace(link, of_link).first->second;
  }

  const Robot& robot_;
  std::map<std::string, Drive> drives_;  ///< of the joints that move
  std::map<std::string, Pose<double>> poses_;
  std::map<std::string, double> loads_;
};

}  // namespace kinecal
