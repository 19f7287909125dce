// A robot moved by your own program, in any language: it exchanges JSON over standard input and
// output.
//
// Each line is one object.  Stamps are whole nanoseconds of any clock, as long as all use the same
// one.  Joint positions are radians or metres; file names are relative to the working directory.
//
//   {"move": {"names": ["elbow"], "positions": [0.5], "velocity_factor": 1.0}}   starts to move
//       {}
//   {"joints": {"after": 17}}                                      waits for positions after that
//       {"stamp": 18, "names": ["elbow"], "positions": [0.49]}
//   {"view": {"after": 17}}                                            waits for a view after that
//       {"stamp": 18, "frame": "camera_optical_frame", "image": "view.png", "depth": "depth.png",
//        "camera": {"width": 640, "height": 480, "distortion_model": "plumb_bob", "d": [0, 0, 0, 0, 0],
//                   "k": [9 numbers], "p": [12 numbers]}}
//   {"light": 3}                                                     lights the LEDs of this code
//       {"stamp": 18}
//
// Images are PNG or JPEG; depth is a 16-bit gray PNG in millimetres, 0 where nothing was measured.
// Instead of a file name they may be {"base64": "..."} of such a file.  A view has an image, depth
// or both; depth needs the camera.  {"error": "the gripper is hot"} skips the pose.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

/// Options for running the program.
struct PipeOptions {
  std::string command;                          ///< for /bin/sh, such as "python3 robot.py"
  std::chrono::milliseconds time_limit{30000};  ///< for each answer
  std::function<bool()> interrupted = {};       ///< returns true to stop waiting for an answer
  /// Receives the request that has no answer yet: "'python3 robot.py': view: no answer for 5 s; ..."
  std::function<void(const std::string& what)> slow = {};
  std::chrono::milliseconds patience{5000};  ///< until `slow` is called
};

/// An arm, a camera and a lamp: see above.  The functions throw
///   PoseError        for an error that the program reports, and for an unreadable answer, with the
///                    reason
///   SilenceError     if an answer does not come in time
///   ConnectionError  once the program has ended, with the reason; for the third unreadable answer
///                    in a row, and if waiting is interrupted
class PipeRobot {
 public:
  /// Starts the program; the destructor ends it.
  explicit PipeRobot(const PipeOptions& options);
  PipeRobot(PipeRobot&&) noexcept;
  PipeRobot& operator=(PipeRobot&&) noexcept;
  ~PipeRobot();

  void move(const JointTarget& target);                   ///< moves the arm
  [[nodiscard]] MeasuredJoints next_joints(Stamp after);  ///< the first reading later than that
  [[nodiscard]] View next_view(Stamp after);              ///< the first image later than that
  [[nodiscard]] Stamp light(int code);                    ///< when the LED was lit

 private:
  class Pipe;
  std::unique_ptr<Pipe> pipe_;
};
static_assert(RobotArm<PipeRobot> && RobotCamera<PipeRobot> && RobotLamp<PipeRobot>);

}  // namespace kinecal
