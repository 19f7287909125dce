// Waits until a robot is still, judged by its joints and images instead of a sleep.
//
// Joints are still when the means of both halves of a time window agree: this ignores encoder noise
// but detects slow creeping.  Two nodes that publish one joint in turn have equal means, too: so
// readings must also be near each other.  An image is still when almost no pixel differs from the previous
// image by more than its noise.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// When a robot counts as still, and how long to wait, on its own clock.
struct SettleOptions {
  Stamp window = std::chrono::milliseconds(300);  ///< in which joints must be still
  double still = 0.001;      ///< change of the mean between its halves, radians or metres
  double most_noise = 0.02;  ///< of a joint's readings while it is still, the same
  double arrival = 0.03;     ///< distance from its target at which a joint has arrived, the same
  Stamp patience = std::chrono::seconds(3);          ///< for a joint that stands still elsewhere
  Stamp time_limit = std::chrono::seconds(30);       ///< for joints
  Stamp image_time_limit = std::chrono::seconds(5);  ///< for the image
  int gray_levels = 25;                              ///< largest change of a pixel by noise
  double still_pixels = 0.002;                  ///< fraction of the pixels that may change by more
  Stamp clock_limit = std::chrono::seconds(5);  ///< allowed difference of camera and joint stamps
  std::set<std::string> continuous = {};        ///< joints that are the same a whole turn away
};

/// Collects readings of joints and decides whether they are at rest.
class JointRest {
 public:
  /// No readings.
  /// @param noise  of each joint's readings at rest, radians or metres; empty: not known
  explicit JointRest(const SettleOptions& options, std::vector<double> noise = {})
      : options_(options), noise_(std::move(noise)) {}

  /// Takes the next reading.  A joint that crosses +-pi makes no whole turn.
  /// @throws PoseError  if its stamp is not later than the last one, its joints differ from the
  ///                    last ones, or a position is not finite
  void add(MeasuredJoints reading);

  /// True if all joints were still during the window.
  [[nodiscard]] bool still() const;

  /// Why joints do not come to rest, as text.
  [[nodiscard]] std::string why_not_still() const;

  /// Mean positions during the window, stamped with the last reading.
  [[nodiscard]] MeasuredJoints mean() const;

  /// The joint farthest from its target, as text; empty if all have arrived.
  /// @throws PoseError  if a joint of the target is not measured
  [[nodiscard]] std::string not_arrived(const JointTarget& target) const;

 private:
  [[nodiscard]] std::vector<double> mean_of(std::size_t first, std::size_t last) const;
  [[nodiscard]] std::vector<double> readings_of(std::size_t joint) const;
  SettleOptions options_;
  std::vector<double> noise_;
  std::deque<MeasuredJoints> readings_;
};

/// Distance between two positions of a joint, radians or metres; for joints that turn without end,
/// whole turns do not count.
/// @param continuous  joints that turn without end: see continuous_joints()
[[nodiscard]] double joint_distance(const std::string& joint, double a, double b,
                                    const std::set<std::string>& continuous);

/// Names of the joints that turn without end.
[[nodiscard]] std::set<std::string> continuous_joints(const Robot& robot);

/// Waits until joints are still, at a target if there is one.
/// @param target  joints that must arrive; without names: wherever they are
/// @param after   ignores earlier readings
/// @returns  mean positions while still
/// @throws PoseError        naming the joint that does not arrive or does not stop
/// @throws ConnectionError  from the arm
template <RobotArm A>
[[nodiscard]] MeasuredJoints settle_joints(A& arm, const JointTarget& target, Stamp after,
                                           const SettleOptions& options = {});

/// Fraction of the pixels that differ by more than noise; 1 if the sizes differ.
[[nodiscard]] double changed_pixels(const GrayImage& a, const GrayImage& b, int gray_levels);

/// Waits for a view with a still image.  Returns a view without image at once.
/// @param next_view  the first view stamped after a time: see RobotCamera
/// @throws PoseError        if the image does not come to rest, its size changes, or its clock
///                          differs from that of the joints
/// @throws ConnectionError  from the camera
[[nodiscard]] View settle_image(const std::function<View(Stamp after)>& next_view, Stamp after,
                                const SettleOptions& options = {});

namespace detail {

/// A duration as text: "12.345 s".
[[nodiscard]] std::string seconds_text(Stamp duration);

/// The step between two readings, radians or metres; a joint that crosses +-pi makes no whole turn.
[[nodiscard]] double unwrapped_step(double from, double to);

/// Standard deviation of readings that follow each other, by their second differences: a steady
/// motion does not count.
///   sigma^2 = mean((q[i-1] - 2 q[i] + q[i+1])^2) / 6
/// @param readings  of one joint; fewer than three: 0
[[nodiscard]] double reading_noise(std::span<const double> readings);

/// Why a view's stamp is of another clock than that of the joints before it; empty if it is not.
[[nodiscard]] std::string clock_fault(Stamp view, Stamp joints, const SettleOptions& options);

}  // namespace detail

template <RobotArm A>
MeasuredJoints settle_joints(A& arm, const JointTarget& target, Stamp after,
                             const SettleOptions& options) {
  JointRest rest(options);
  MeasuredJoints reading = arm.next_joints(after);
  const Stamp start = reading.stamp;
  Stamp moved = start;  // when they last moved
  std::string missing;
  while (true) {
    const Stamp now = reading.stamp;
    rest.add(std::move(reading));
    if (rest.still()) {
      missing = rest.not_arrived(target);
      if (missing.empty()) return rest.mean();
      if (now - moved > options.patience) throw PoseError(missing);
    } else {
      moved = now;
      missing = rest.why_not_still();
    }
    if (now - start > options.time_limit) {
      throw PoseError(missing + "; waited " + detail::seconds_text(now - start));
    }
    reading = arm.next_joints(now);
  }
}

}  // namespace kinecal
