// The motion of a simulated joint: constant acceleration up to a speed, deceleration, then a swing.
//
//   after its arrival at time T:  q = target + swing exp(-(t - T) / decay) sin(2 pi f (t - T))
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kinecal {

/// The drive of a joint, and the swing of its load.
struct JointDrive {
  double speed = 1.0;         ///< maximum, radians or metres per second
  double acceleration = 2.0;  ///< radians or metres per second squared
  double swing = 0.004;       ///< after the arrival at full speed, radians or metres
  double frequency = 8.0;     ///< of the swing, Hz
  double decay = 0.25;        ///< of the swing to 1/e, seconds
};

/// The motion of one joint from one position to another.
class JointMotion {
 public:
  JointMotion() = default;
  /// @param factor  of the drive's speed, above zero
  JointMotion(double from, double to, const JointDrive& drive, double factor = 1.0)
      : from_(from), to_(to), drive_(drive) {
    const double distance = std::abs(to - from);
    const double most = drive.speed * factor;
    speed_ = std::min(most, std::sqrt(distance * drive.acceleration));
    if (!(distance > 0.0) || !(speed_ > 0.0)) return;
    rising_ = speed_ / drive.acceleration;
    arrival_ = distance / speed_ + rising_;
    swing_ = drive.swing * speed_ / drive.speed;
  }

  /// Position at a time since the start, radians or metres.
  /// @param t  seconds
  [[nodiscard]] double position(double t) const {
    if (t >= arrival_) return to_ + swung(t - arrival_);
    if (t <= 0.0) return from_;
    const double acceleration = speed_ / rising_;
    const double left = arrival_ - t;
    double way = speed_ * (t - 0.5 * rising_);
    if (t < rising_) way = 0.5 * acceleration * t * t;
    if (left < rising_) way = std::abs(to_ - from_) - 0.5 * acceleration * left * left;
    return to_ > from_ ? from_ + way : from_ - way;
  }

  /// Time of arrival at the target, seconds since the start; it may still swing.
  [[nodiscard]] double arrival() const { return arrival_; }
  /// Time at which all motion has stopped, seconds since the start.
  [[nodiscard]] double rest() const {
    return swing_ > 0.0 ? arrival_ + kDecays * drive_.decay : arrival_;
  }
  /// Where it goes, radians or metres.
  [[nodiscard]] double target() const { return to_; }
  /// Its sign: 1, -1, or 0 if it does not move.
  [[nodiscard]] int direction() const { return to_ > from_ ? 1 : to_ < from_ ? -1 : 0; }

 private:
  static constexpr double kDecays = 10.0;  ///< then the swing is 1 / 20 000 of its start

  [[nodiscard]] double swung(double t) const {
    if (swing_ == 0.0 || t > kDecays * drive_.decay) return 0.0;
    return swing_ * std::exp(-t / drive_.decay) *
           std::sin(2.0 * std::numbers::pi * drive_.frequency * t);
  }

  double from_ = 0.0, to_ = 0.0, speed_ = 0.0, rising_ = 0.0, arrival_ = 0.0, swing_ = 0.0;
  JointDrive drive_;
};

}  // namespace kinecal
