// Calibrates during a capture session: from a configuration and the samples so far, how well the
// gripper is known in the camera's frame, whether the last sample is good, and what to move next.
//
// The first samples are calibrated as a whole, which finds unknown poses; from then on each sample is
// an update (trust/online.hpp).  If two samples in a row do not fit, the start may have been
// wrong, and all samples are calibrated anew.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/trust/online.hpp"

namespace kinecal {

/// What is known after a sample.
struct FollowedState {
  OnlineState online;            ///< the pose and how well it is known
  std::optional<NextMove> next;  ///< what to move next; nullopt if the pose is not known
  std::string problem;           ///< why the sample cannot be used; empty if it can
};

/// Follows a session.
class SessionFollower {
 public:
  /// @param frame  link or free frame whose pose is wanted; empty: what the first error block of
  ///               the last step compares
  /// @throws InputError  if the configuration does not suit the robot, or the robot has no such
  ///                     link, with the nearest name
  SessionFollower(Config config, Robot robot, const std::string& frame = {});
  SessionFollower(const SessionFollower&) = delete;
  SessionFollower& operator=(const SessionFollower&) = delete;
  ~SessionFollower() = default;

  /// Takes the next sample of the session.
  /// @param ahead  poses that are left, where the pose is wanted as well
  FollowedState add(const Sample& sample, std::span<const Sample> ahead = {});

  /// The frame whose pose is meant, and the one in which it is meant; empty before it is known.
  [[nodiscard]] std::pair<std::string, std::string> frames() const;

 private:
  void check(const Sample& sample) const;
  [[nodiscard]] bool start();
  [[nodiscard]] OnlineState start_again(std::span<const Sample> ahead);

  Config config_;
  Robot robot_;
  std::string frame_;
  ParameterTable table_;         ///< at the initial values
  std::vector<Sample> samples_;  ///< all of the session that suit the configuration
  std::optional<OnlineCalibration> online_;
  std::optional<std::pair<FrameOnRobot, FrameOnRobot>> frames_;
  int misfits_ = 0;  ///< samples in a row that do not fit
};

/// When a session may end: "gripper 1 mm", "gripper 0.1 deg", "wrist_roll_link 0.5 mm".
struct Accuracy {
  std::string frame;               ///< link or free frame; empty for "gripper"
  std::optional<double> position;  ///< standard deviation, metres
  std::optional<double> rotation;  ///< the same, radians

  /// True if a pose is known as well as that.
  [[nodiscard]] bool reached(const OnlineState& state) const;
};

/// @throws InputError  if the text is not a name, a positive number and one of mm, cm, m, deg, rad
[[nodiscard]] Accuracy parse_accuracy(const std::string& text);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/config/capture/session_follower.ipp"
#endif
