// Drives of a mobile robot: how its base moved between two samples, by its wheels or by the odometry that it reports.
//
//   d = rollout R (what a wheel turned),  b the track width, L the wheelbase, a the steering angle
//
//   differential  ahead (d_r + d_l) / 2                        turn (d_r - d_l) / b
//   mecanum       ahead (d_fl + d_fr + d_rl + d_rr) / 4        turn (d_fr + d_rr - d_fl - d_rl) / (4 b)
//                 left  (d_fr + d_rl - d_fl - d_rr) / 4        b half the track width and half the wheelbase
//   tricycle      ahead d cos a                                turn d sin a / L
//
// Between two samples wheels turn in a fixed ratio: the base moves on an arc, which is integrated exactly.  The base is the
// middle between the wheels of a differential drive, and the middle of the rear axle of a tricycle.
// Source: Siegwart, Nourbakhsh, Introduction to Autonomous Mobile Robots, 2004, chapter 3; Censi et al., Simultaneous
// calibration of odometry and sensor parameters for mobile robots, 2013; Taheri et al., Kinematic model of a four mecanum
// wheeled mobile robot, 2015.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "kinecal/geometry/planar_motion.hpp"
#include "kinecal/parameters/parameter.hpp"

namespace kinecal {

namespace detail {

/// A factor of what is nominal: 1 says that nothing is wrong.
[[nodiscard]] constexpr ParameterInfo scale_parameter(std::string_view name) {
  return {name, "1", 1.0, 0.1, 10.0};
}

}  // namespace detail

/// Two wheels beside each other.  Conditions: their positions, radians.
struct DifferentialDrive {
  static constexpr std::array kParameters = {detail::scale_parameter("track_width_scale"),
                                             detail::scale_parameter("rollout_scale"),
                                             detail::scale_parameter("left_rollout_scale"),
                                             detail::scale_parameter("right_rollout_scale")};
  static constexpr std::array<std::string_view, 4> kConditions = {
      "left_wheel", "right_wheel", "before left_wheel", "before right_wheel"};

  double wheel_radius = 1.0;  ///< metres; 1: the positions are metres
  double track_width = 1.0;   ///< metres between the wheels

  /// The motion of the base since the sample before.
  /// @param own  track width, rollout of both wheels, of the left and of the right one: factors
  /// @param at   positions of the wheels, now and before
  template <class S, class Q>
  [[nodiscard]] PlanarMotion<S> motion(const S* own, const Q* at) const {
    const S left = own[1] * own[2] * (wheel_radius * (at[0] - at[2])),
            right = own[1] * own[3] * (wheel_radius * (at[1] - at[3]));
    return planar_exp(S(0.5 * (left + right)), S(0.0), S((right - left) / (own[0] * track_width)));
  }
};

/// Four wheels with rollers at 45 degrees.  Conditions: their positions, radians.
struct MecanumDrive {
  static constexpr std::array kParameters = {detail::scale_parameter("track_width_scale"),
                                             detail::scale_parameter("rollout_scale"),
                                             detail::scale_parameter("lateral_scale")};
  static constexpr std::array<std::string_view, 8> kConditions = {
      "front_left_wheel",       "front_right_wheel",       "rear_left_wheel",
      "rear_right_wheel",       "before front_left_wheel", "before front_right_wheel",
      "before rear_left_wheel", "before rear_right_wheel"};

  double wheel_radius = 1.0;  ///< metres; 1: the positions are metres
  double track_width = 1.0;   ///< metres between the wheels of an axle
  double wheelbase = 1.0;     ///< metres between the axles

  /// The motion of the base since the sample before.
  /// @param own  track width and wheelbase, rollout, and rollout to the side: factors
  /// @param at   positions of the wheels, now and before
  template <class S, class Q>
  [[nodiscard]] PlanarMotion<S> motion(const S* own, const Q* at) const {
    const auto turned = [&](int wheel) { return Q(at[wheel] - at[4 + wheel]); };
    const S unit = 0.25 * wheel_radius * own[1];
    const Q fl = turned(0), fr = turned(1), rl = turned(2), rr = turned(3);
    return planar_exp(S(unit * (fl + fr + rl + rr)), S(unit * own[2] * (fr + rl - fl - rr)),
                      S(unit * (fr + rr - fl - rl) / (own[0] * (0.5 * (track_width + wheelbase)))));
  }
};

/// A driven wheel that steers, and an axle behind it.  Conditions: its position and its steering angle to the left, radians.
struct TricycleDrive {
  static constexpr std::array kParameters = {
      detail::scale_parameter("wheelbase_scale"), detail::scale_parameter("rollout_scale"),
      detail::scale_parameter("steering_scale"), ParameterInfo{"steering_offset", "rad"}};
  static constexpr std::array<std::string_view, 4> kConditions = {
      "wheel", "steering", "before wheel", "before steering"};

  double wheel_radius = 1.0;  ///< metres; 1: the positions are metres
  double wheelbase = 1.0;     ///< metres between the steered wheel and the axle

  /// The motion of the base since the sample before, with the mean of both steering angles.
  /// @param own  wheelbase, rollout and steering: factors; steering angle that is added, radians
  /// @param at   position of the wheel and its angle, now and before
  template <class S, class Q>
  [[nodiscard]] PlanarMotion<S> motion(const S* own, const Q* at) const {
    using std::cos, std::sin;
    const S way = own[1] * (wheel_radius * (at[0] - at[2])),
            angle = own[2] * (0.5 * (at[1] + at[3])) + own[3];
    return planar_exp(S(way * cos(angle)), S(0.0), S(way * sin(angle) / (own[0] * wheelbase)));
  }
};

/// A base that reports its odometry.  Conditions: its pose, metres and radians; the angle does not jump at a full turn.
struct ReportedOdometry {
  static constexpr std::array kParameters = {detail::scale_parameter("track_width_scale"),
                                             detail::scale_parameter("rollout_scale")};
  static constexpr std::array<std::string_view, 6> kConditions = {
      "odom_x", "odom_y", "odom_yaw", "before odom_x", "before odom_y", "before odom_yaw"};

  /// The motion of the base since the sample before: the reported arc with its lengths and its angle to scale.  What was
  /// reported of a turn by more than 3 radians may be several arcs: its chord keeps its length.
  /// @param own  track width, rollout: factors
  /// @param at   the pose, now and before
  template <class S, class Q>
  [[nodiscard]] PlanarMotion<S> motion(const S* own, const Q* at) const {
    using std::abs, std::cos, std::sin;
    constexpr double kOneArc = 3.0;  // radians
    const Q turned = at[2] - at[5];
    const PlanarMotion<Q> before = PlanarMotion<Q>::at(at[3], at[4], at[5]),
                          now = PlanarMotion<Q>::at(at[0], at[1], at[2]),
                          reported = before.inverse() * now;
    const S turn = turned * (own[1] / own[0]), half = 0.5 * (turn - turned);
    const auto is_arc = abs(S(turned)) < S(kOneArc);
    const Q chord = detail::sinc(Q(0.5 * turned));
    const S ratio = select(
                is_arc, S(detail::sinc(S(0.5 * turn)) / select(is_arc, S(chord), S(1.0))), S(1.0)),
            c = own[1] * ratio * cos(half), s = own[1] * ratio * sin(half);
    return {c * reported.x - s * reported.y, s * reported.x + c * reported.y, cos(turn), sin(turn)};
  }
};

}  // namespace kinecal
