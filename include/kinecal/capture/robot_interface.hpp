// The interface of a robot for capture: concepts of an arm, a camera, a lamp and a finder.
//
// A robot is these few functions, over any middleware.  Each waits for its result, on the robot's
// own clock, and throws if it does not arrive.
//
//   struct MyArm {
//     void move(const JointTarget& target);      // starts to move, does not wait
//     MeasuredJoints next_joints(Stamp after);   // the first that were measured after this time
//   };
//
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/view.hpp"

namespace kinecal {

/// The robot failed in one pose, which is then skipped: "elbow did not arrive".
struct PoseError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A stream of the robot, such as joint states or images, delivered nothing in time.  The pose is
/// skipped; if it is still silent in a later pose, the session ends.
struct SilenceError : PoseError {
  SilenceError(const std::string& what, std::string name, std::optional<Stamp> last)
      : PoseError(what), stream(std::move(name)), newest(last) {}  ///< what: the message

  std::string stream;           ///< its name, such as a topic
  std::optional<Stamp> newest;  ///< of its last message; nullopt if there was none
};

/// The connection to the robot is lost; the session ends.
struct ConnectionError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Positions to move joints to.
struct JointTarget {
  std::vector<std::string> names;  ///< of joints; others stay
  std::vector<double> positions;   ///< radians or metres, in the order of the names
  double velocity_factor = 1.0;    ///< of the robot's usual speed, (0, 1]
};

/// A robot whose joints move and are measured.
///   arm.move(target)        starts to move; throws PoseError if the robot refuses
///   arm.next_joints(after)  waits for positions stamped after this time; throws SilenceError if
///                           none come within the adapter's time limit
/// Both throw ConnectionError if the robot cannot be reached.
template <class A>
concept RobotArm = requires(A& arm, const JointTarget& target, Stamp after) {
  { arm.move(target) } -> std::same_as<void>;
  { arm.next_joints(after) } -> std::same_as<MeasuredJoints>;
};

/// A camera.
///   camera.next_view(after)  waits for a view stamped after this time; throws like a RobotArm.  Its joints
///                            may be empty: the session fills them in.
template <class C>
concept RobotCamera = requires(C& camera, Stamp after) {
  { camera.next_view(after) } -> std::same_as<View>;
};

/// LEDs that can be switched.
///   lamp.light(code)  lights only the LEDs of this code, 0: none; returns the time of the switch;
///                     throws like a RobotArm
template <class L>
concept RobotLamp = requires(L& lamp, int code) {
  { lamp.light(code) } -> std::same_as<Stamp>;
};

/// Finds features of a target in a view.  Does not throw if it finds nothing.
///   finder.find(view)         observations of two or more sensors, or why they are missing
/// Those of a capture.yaml (FinderSettings) may have, too:
///   finder.fault(view)        why a view cannot be searched, whatever it shows; empty if it can
///   finder.region_frame()     link in whose frame it searches; empty: the camera's own
///   finder.place_on(camera_in)  takes the poses of the camera in links from CameraIn, as the robot is known
template <class F>
concept Finder = requires(const F& finder, const View& view) {
  { finder.find(view) } -> std::same_as<Found>;
};

}  // namespace kinecal
