// A simulated robot for capture without hardware: it moves, looks and switches its LEDs, on its own
// clock.  Nothing sleeps: waiting advances the clock, so a ten-minute session takes seconds.
//
// A joint is where its encoder says, plus two invisible errors: backlash by the direction of
// approach, and an error that is new at each stop.  In addition, the true robot differs from its
// URDF by the parameters in `truth`: joint zeros and frames (study/true_robot.hpp), the camera's
// <name>_fx ... <name>_z_scaling.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/study/joint_motion.hpp"
#include "kinecal/study/scene.hpp"
#include "kinecal/study/simulated_camera.hpp"
#include "kinecal/study/true_robot.hpp"

namespace kinecal {

/// Timing of messages, and accuracy of joints.
struct SimulatedTiming {
  double joint_rate = 100.0;        ///< Hz
  double image_rate = 15.0;         ///< Hz
  double image_latency = 0.06;      ///< from the exposure to delivery, seconds
  double exposure = 0.0;            ///< how long an image gathers light until its stamp, seconds
  double late_stamps = 0.0;         ///< an image's stamp less its exposure, seconds
  double lamp_latency = 0.04;       ///< from the command to light, seconds
  double lamp_answers_early = 0.0;  ///< by how much the lamp reports a switch too early, seconds
  double encoder_noise = 2e-5;      ///< standard deviation, radians or metres
  double repeatability = 5e-5;      ///< standard deviation at each stop, radians or metres
  double backlash = 1e-4;           ///< between both directions, radians or metres
};

/// Faults, for tests.
struct Faults {
  static constexpr double kNever = std::numeric_limits<double>::infinity();  ///< seconds

  std::string stuck_joint = {};     ///< stops at half of its way
  double joints_end = kNever;       ///< no joint positions come after this time, seconds
  double views_end = kNever;        ///< no images come after this time, seconds
  double connection_ends = kNever;  ///< no answers after this time, seconds
  double other_clock = 0.0;         ///< added to stamps of images, seconds
  int dark_led = 0;                 ///< code of an LED that does not light; 0: all do
  bool no_camera_info = false;      ///< the driver does not send it
  double passer_by = 0.0;           ///< chance that something hides part of an image
  double outliers = 0.0;            ///< chance that joints are elsewhere than they say, at a stop
  double outlier_size = 0.05;       ///< of one joint, radians or metres
};

/// A simulated robot and its surroundings.
struct SimulatedSetup {
  Robot robot;                                ///< as in its URDF
  std::string base;                           ///< fixed link; the world of the scene
  ParameterTable truth = {};                  ///< errors of the URDF and of the camera
  std::set<std::string> frames = {};          ///< joints whose frames `truth` corrects
  SimulatedCamera camera = {};                ///< takes its errors from `truth`
  std::string camera_name = "camera";         ///< prefix of its parameters in `truth`
  Scene scene = {};                           ///< visible objects
  std::map<std::string, double> speeds = {};  ///< of joints, radians or metres per second
  JointDrive drive = {};                      ///< of joints that turn; others have a tenth
  SimulatedTiming timing = {};                ///< of messages, and how exact joints are
  Faults faults = {};                         ///< what goes wrong
  Positions start = {};                       ///< of joints; others start within limits near zero
  std::uint64_t seed = 1;                     ///< same seed: same robot, noise and faults
};

/// A robot, its camera and its lamp: models RobotArm, RobotCamera and RobotLamp.
class SimulatedRobot {
 public:
  /// @throws std::invalid_argument  if setup names links or joints that the robot does not have, or
  ///                                a joint of `start` that does not move
  explicit SimulatedRobot(SimulatedSetup setup);
  ~SimulatedRobot();
  SimulatedRobot(SimulatedRobot&&) noexcept;             ///< do not use the other one afterwards
  SimulatedRobot& operator=(SimulatedRobot&&) noexcept;  ///< the same

  /// Starts a move.  Refuses positions beyond limits.
  /// @throws PoseError        if a joint does not exist or cannot reach its position
  /// @throws ConnectionError  after Faults::connection_ends; so do all functions below
  void move(const JointTarget& target);

  /// Positions of all driven joints.
  /// @throws SilenceError  if none arrive any more
  [[nodiscard]] MeasuredJoints next_joints(Stamp after);

  /// Image and cloud; without joints.
  /// @throws SilenceError  if none arrive any more
  [[nodiscard]] View next_view(Stamp after);

  /// Lights the LEDs of a code.
  Stamp light(int code);

  /// Advances the clock until nothing moves.
  void wait_for_rest();

  /// The robot's time.
  [[nodiscard]] Stamp now() const;

  /// True positions of the joints, before the offsets in `truth`: radians or metres.
  [[nodiscard]] Positions true_positions() const;

  /// True pose of a link in the camera at this moment: camera_T_link, metres.
  [[nodiscard]] Pose<double> in_camera(const std::string& link) const;

  /// The true projection of the camera.
  [[nodiscard]] const SimulatedLens& lens() const;

  /// The setup it was made from.
  [[nodiscard]] const SimulatedSetup& setup() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
static_assert(RobotArm<SimulatedRobot> && RobotCamera<SimulatedRobot> && RobotLamp<SimulatedRobot>);

}  // namespace kinecal
