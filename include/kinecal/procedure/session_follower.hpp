// Calibrates during a capture session.  From a configuration and the samples so far it gives the
// uncertainty of the gripper's pose in the camera's frame, the quality of the last sample, and the
// next move.
//
// The first samples are calibrated as a whole, which finds unknown poses; after that, each sample
// is an update (trust/online.hpp).  If two samples in a row do not fit, the start may have been
// wrong, and all samples are calibrated anew.
//
// Where the robot is its own target, what belongs together is another thing for each solution: all samples are associated,
// calibrated and assessed anew with each.  The next move is not known then.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/session/capture_pose.hpp"
#include "kinecal/config/config.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/trust/online.hpp"
#include "kinecal/trust/uncertainty/compared_frames.hpp"

namespace kinecal {

/// The state after a sample.
struct FollowedState {
  OnlineState online;            ///< the pose and its uncertainty
  std::optional<NextMove> next;  ///< nullopt if the pose is unknown
  std::string problem;           ///< why the sample is unusable; empty if it is usable
};

/// The joint positions of a pose; joints that it does not move are where they are in a sample.
[[nodiscard]] Sample at_pose(const CapturePose& pose, const Sample& sample);

/// Follows a session.
class SessionFollower {
 public:
  /// @param urdf_text  of the robot: see CalibrationSetup
  /// @param urdf       its file, beside which its meshes are
  /// @param options    of the calibrations
  /// @param frame  link or free frame whose pose is wanted; empty: that of the first error block of
  ///               the last step
  /// @throws InputError  if the configuration does not match the robot or has `per_sample`, or the robot has no such
  ///                     link, with the nearest name
  SessionFollower(Config config, Robot robot, const std::string& frame = {},
                  std::string urdf_text = {}, std::string urdf = CalibrationSetup{}.urdf,
                  CalibrationOptions options = {});
  SessionFollower(const SessionFollower&) = delete;
  SessionFollower& operator=(const SessionFollower&) = delete;
  ~SessionFollower() = default;

  /// Adds the next sample of the session.
  /// @param ahead  remaining poses, where the pose is wanted as well
  FollowedState add(const Sample& captured, std::span<const Sample> ahead = {});

  /// The robot, its configuration and all samples so far.
  [[nodiscard]] CalibrationSetup setup() const;
  /// Calibrates and judges all samples so far.
  /// @throws InputError  if they do not suffice
  [[nodiscard]] CalibratedRobot calibrate_all() const {
    return calibrate_robot(prepare(setup(), options_), options_);
  }
  /// Those of its calibrations.
  [[nodiscard]] const CalibrationOptions& options() const { return options_; }

  /// The frame whose pose is meant, and the one in which it is meant; empty before it is known.
  [[nodiscard]] std::pair<std::string, std::string> frames() const;

 private:
  [[nodiscard]] Sample at_rest(Sample sample) const;
  void check(const Sample& sample) const;
  [[nodiscard]] bool start();
  [[nodiscard]] bool find_frames(const AnyProblem& problem, std::span<const Sample> samples);
  [[nodiscard]] OnlineState start_again(std::span<const Sample> ahead);
  void calibrate_surface(std::span<const Sample> ahead, FollowedState& followed);

  Config config_;
  Robot robot_;
  std::string frame_;
  std::string urdf_text_, urdf_;
  CalibrationOptions options_;
  std::unique_ptr<AnyProblem> problem_;  ///< of the last step, without samples
  std::vector<Sample> samples_;          ///< all of the session that suit the configuration
  std::optional<OnlineCalibration> online_;
  std::optional<ComparedFrames> frames_;  ///< whose pose it waits for
  int misfits_ = 0;                       ///< samples in a row that do not fit
  std::set<int>
      left_out_{};  ///< numbers of samples that calibrations of a surface left out, from 1
};

/// When a session may end: "gripper 1 mm", "gripper 0.1 deg", "wrist_roll_link 0.5 mm".
struct Accuracy {
  std::string frame;               ///< link or free frame; empty for "gripper"
  std::optional<double> position;  ///< standard deviation, metres
  std::optional<double> rotation;  ///< the same, radians

  /// True if a pose is at least this accurate.
  [[nodiscard]] bool reached(const OnlineState& state) const;
};

/// @throws InputError  if the text is not a name, a positive number and one of mm, cm, m, deg, rad
[[nodiscard]] Accuracy parse_accuracy(const std::string& text);

}  // namespace kinecal
