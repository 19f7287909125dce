// A robot whose parts are chosen at run time: simulated, over a network, or your own program.
//
// AnyArm, AnyCamera and AnyLamp are models of the concepts and hold any other model.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

/// Any arm.
struct AnyArm {
  std::function<void(const JointTarget&)> mover;      ///< see RobotArm
  std::function<MeasuredJoints(Stamp after)> reader;  ///< see RobotArm

  void move(const JointTarget& target) { mover(target); }            ///< see RobotArm
  MeasuredJoints next_joints(Stamp after) { return reader(after); }  ///< see RobotArm
};

/// Any camera.
struct AnyCamera {
  std::function<View(Stamp after)> viewer;  ///< see RobotCamera

  View next_view(Stamp after) { return viewer(after); }  ///< see RobotCamera
};

/// Any lamp.
struct AnyLamp {
  std::function<Stamp(int code)> lighter;  ///< see RobotLamp

  Stamp light(int code) { return lighter(code); }  ///< see RobotLamp
};

static_assert(RobotArm<AnyArm> && RobotCamera<AnyCamera> && RobotLamp<AnyLamp>);

/// A robot to capture, and the object that owns its parts.
struct AnyRobot {
  AnyArm arm;
  std::map<std::string, AnyCamera> cameras;  ///< by the name of the finder that looks through it
  std::map<std::string, AnyLamp> lamps;      ///< by the name of the finder that switches it
  std::shared_ptr<void> owner = {};          ///< of all of them
};

/// An arm of any type.
/// @param arm  must outlive the result
template <RobotArm A>
[[nodiscard]] AnyArm any_arm(A& arm) {
  return {[&arm](const JointTarget& target) { arm.move(target); },
          [&arm](Stamp after) { return arm.next_joints(after); }};
}

/// A camera of any type.
/// @param camera  must outlive the result
template <RobotCamera C>
[[nodiscard]] AnyCamera any_camera(C& camera) {
  return {[&camera](Stamp after) { return camera.next_view(after); }};
}

/// A lamp of any type.
/// @param lamp  must outlive the result
template <RobotLamp L>
[[nodiscard]] AnyLamp any_lamp(L& lamp) {
  return {[&lamp](int code) { return lamp.light(code); }};
}

}  // namespace kinecal
