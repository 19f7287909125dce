// What gravity does to the joints of a robot in a pose.
//
//   load of joint j = sum over masses m of  m g . dp/dq_j        (virtual work; g: gravity, p: place)
//
// Source: Siciliano et al., Robotics: Modelling, Planning and Control, 7.1.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kinecal/geometry/rotation.hpp"
#include "kinecal/kinematics/joint_state.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// What gravity does to a robot's joints in a pose.
class GravityLoads {
 public:
  /// Loads by joint that does not mimic: torque about its axis, N m, or force along it, N; joints
  /// without one are absent.
  using ByJoint = std::map<std::string, double>;

  /// @param robot        must outlive this
  /// @param position_of  callable: name of a joint that does not mimic -> its position, radians or
  ///                     metres
  template <class PositionOf>
  GravityLoads(const Robot& robot, PositionOf&& position_of) : robot_(robot) {
    for (const Joint& joint : robot.joints()) {
      State& state = states_.emplace_back();
      if (!moves(joint.type)) continue;
      state.by = drive(robot, joint);
      state.position = state.by.multiplier * position_of(state.by.joint) + state.by.offset;
    }
  }

  /// Adds the loads of a point mass.
  /// @param center  (3) metres, in the link
  /// @param mass    kg
  void add(const std::string& link, const Vector3<double>& center, double mass, ByJoint& loads) {
    const Joint* joint = robot_.parent_joint(link);
    if (joint == nullptr) return;  // it is on the root
    const Vector3<double> force = mass * robot_.weight().gravity;
    const Vector3<double> place = passed(*joint).child * center;
    for (; joint != nullptr; joint = robot_.parent_joint(joint->parent)) {
      if (!moves(joint->type)) continue;
      const State& state = passed(*joint);
      const Vector3<double> velocity =
          turns(joint->type) ? cross(state.axis, Vector3<double>(place - state.origin))
                             : state.axis;
      loads[state.by.joint] += state.by.multiplier * force.dot(velocity);
    }
  }
  /// The loads of all links.
  [[nodiscard]] ByJoint of_links() {
    ByJoint loads;
    for (const auto& [link, of] : robot_.weight().links) add(link, of.center, of.mass, loads);
    return loads;
  }

 private:
  struct State {
    Mimic by;  ///< the joint that drives it
    double position = 0.0;
    bool is_passed = false;        ///< what follows is known
    Vector3<double> origin, axis;  ///< (3) in the root link
    Pose<double> child;            ///< the child link in the root link
  };

  /// A joint whose pose in the root link is known.
  const State& passed(const Joint& joint) {
    State& state = states_[static_cast<std::size_t>(&joint - robot_.joints().data())];
    if (state.is_passed) return state;
    const Joint* before = robot_.parent_joint(joint.parent);
    const Pose<double> frame =
        before == nullptr ? joint.origin : passed(*before).child * joint.origin;
    state.origin = frame.translation;
    state.axis = frame.rotation * joint.axis;
    state.child = moves(joint.type)
                      ? frame * joint_pose(joint.type, joint.axis, make_joint_state(state.position))
                      : frame;
    state.is_passed = true;
    return state;
  }

  const Robot& robot_;
  std::vector<State> states_;  ///< of the robot's joints
};

}  // namespace kinecal
