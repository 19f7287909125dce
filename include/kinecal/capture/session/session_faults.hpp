// Faults that end a capture session: silent streams, and what fails in every pose.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "kinecal/capture/session/session_pose.hpp"

namespace kinecal {

/// A session has no hope: each pose would fail alike.
struct HopelessError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Why joint positions cannot be radians of this robot: one far beyond its limits, as degrees are;
/// empty if all can be.
[[nodiscard]] std::string like_degrees(const MeasuredJoints& joints, const Robot& robot);

namespace detail {

/// Streams that have been silent.
class SilentStreams {
 public:
  /// Why the session must end; empty if this is the stream's first silence, or if it has delivered
  /// something since the last one.
  [[nodiscard]] std::string add(const SilenceError& error);

 private:
  std::map<std::string, std::optional<Stamp>> newest_;  ///< stamps, by stream
};

/// Counts poses that fail alike.
class AlikeFaults {
 public:
  /// Why the session must end; empty if it may go on.
  /// @param most  poses; 0: any number
  [[nodiscard]] std::string add(const CapturedPose& pose, int most);

 private:
  bool found_ = false;  ///< a sample
  int count_ = 0;
  std::string last_;  ///< fault, without its numbers
};

/// Finds cameras that send the same image, and the same points if they measure depth, again and
/// again.  Two images of a real camera differ by noise.
class FrozenCameras {
 public:
  /// Takes what finders have seen in a pose.
  /// @throws SilenceError  if a finder found its target in the very image of the last pose, although
  ///                       a joint has moved
  void add(const MeasuredJoints& joints, std::span<const FinderOutcome> outcomes,
           const SettleOptions& options);

 private:
  struct Seen {
    MeasuredJoints joints;
    Stamp stamp;  ///< of the first view with this image
    GrayImage image;
    PointCloud points;
  };
  std::map<std::string, Seen> last_;  ///< by finder
};

/// A pose's joint that is not measured; empty if all are.
[[nodiscard]] std::string not_measured(const CapturePose& pose, const MeasuredJoints& joints);

/// Why no view of a finder can be used; empty if one could.
/// @throws PoseError  like a RobotCamera
[[nodiscard]] std::string useless_views(const SessionFinder& finder, Stamp joints,
                                        const SettleOptions& options);

/// What would fail in every pose, found without a motion; empty if nothing would.
template <RobotArm A>
[[nodiscard]] std::string first_look(A& arm, const CapturePose& pose,
                                     std::span<const SessionFinder* const> finders,
                                     const SessionOptions& options) {
  std::string why;
  for (int attempt = 0; attempt < 2; ++attempt) {  // the first message may be of the past
    try {
      const MeasuredJoints joints = arm.next_joints(Stamp::min());
      why = not_measured(pose, joints);
      if (why.empty() && options.fault) why = options.fault(joints);
      for (std::size_t i = 0; i < finders.size() && why.empty(); ++i) {
        why = useless_views(*finders[i], joints.stamp, options.settling);
      }
    } catch (const PoseError& error) {
      why = error.what();
    }
    if (why.empty()) break;
  }
  return why;
}

}  // namespace detail

}  // namespace kinecal
