// How the base of a mobile robot moved between two samples, against what was seen from it: the pose of a sensor that is
// tracked (<drive>_to_pose), a wall in front of a laser (<drive>_to_wall), and the same of a gyroscope.
//
//   B  motion of the base by its drive,  X  pose of the sensor on the base,  P = X^-1 B X  that of the sensor
//
//   pose   r = log(T^-1 P), T the tracked motion of the sensor: (2) metres times translation_scale,
//              (1) radians times rotation_scale
//   wall   n = (cos a, sin a) towards the wall at the distance d, in the sensor's frame, now and before (0):
//          r = ((d - d0 + n0 . t_P) translation_scale, (a - a0 + angle of P) rotation_scale)
//   gyro   r = scale (integral of its rate) + bias (time) - the angle that was seen
//
// Angles are compared within half a turn: what is seen need not count turns.  The pose of the sensor on the base is x, y, yaw
// of the block.  Samples of two runs are not compared (set_before()).
// Source: Censi et al., Simultaneous calibration of odometry and sensor parameters for mobile robots, 2013; the wall:
// base_calibration of robot_calibration.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kinecal/errors/base_drives.hpp"
#include "kinecal/errors/error_block.hpp"

namespace kinecal {

namespace detail {

template <class T, std::size_t N, std::size_t M>
[[nodiscard]] constexpr std::array<T, N + M> concatenated(const std::array<T, N>& a,
                                                          const std::array<T, M>& b) {
  std::array<T, N + M> all{};
  std::copy(a.begin(), a.end(), all.begin());
  std::copy(b.begin(), b.end(), all.begin() + N);
  return all;
}

inline constexpr std::array<std::string_view, 6> kTracked = {
    "track_x", "track_y", "track_yaw", "before track_x", "before track_y", "before track_yaw"};
inline constexpr std::array<std::string_view, 4> kWall = {
    "wall_angle", "wall_distance", "before wall_angle", "before wall_distance"};

/// The motion that was tracked.
/// @param at  x, y, yaw, now and before
template <class Q>
[[nodiscard]] PlanarMotion<Q> tracked_motion(const Q* at) {
  return PlanarMotion<Q>::at(at[3], at[4], at[5]).inverse() *
         PlanarMotion<Q>::at(at[0], at[1], at[2]);
}

/// A drive and a sensor on the base.
/// @tparam D  the drive
template <class D>
struct SensorOnBase {
  static constexpr const char* kUnit = "1";  ///< of the residual
  static constexpr auto kParameters = concatenated(
      D::kParameters,
      std::array{ParameterInfo{"x", "m"}, ParameterInfo{"y", "m"}, ParameterInfo{"yaw", "rad"}});

  D drive = {};                    ///< its nominal dimensions
  std::array<double, 3> mount{};   ///< x, y, metres, and yaw, radians, of the sensor on the base
  double translation_scale = 1.0;  ///< 1 / metre: one over the standard deviation of a translation
  double rotation_scale = 1.0;     ///< 1 / radian: one over the standard deviation of a rotation

  /// Initial values of the parameters.
  [[nodiscard]] std::array<double, kParameters.size()> initial() const {
    std::array<double, kParameters.size()> all{};
    for (std::size_t i = 0; i < D::kParameters.size(); ++i) all[i] = D::kParameters[i].initial;
    std::copy(mount.begin(), mount.end(), all.end() - 3);
    return all;
  }
  /// Motion of the sensor by the drive.
  template <class S, class Q>
  [[nodiscard]] PlanarMotion<S> motion(const std::array<S, kParameters.size()>& own,
                                       const Q* at) const {
    const S* pose = own.data() + D::kParameters.size();
    const PlanarMotion<S> base_T_sensor = PlanarMotion<S>::at(pose[0], pose[1], pose[2]);
    return base_T_sensor.inverse() * drive.motion(own.data(), at) * base_T_sensor;
  }
};

/// A drive against the tracked pose of a sensor on the base.
template <class D>
struct DriveToPose : SensorOnBase<D> {
  static constexpr auto kConditions = concatenated(D::kConditions, kTracked);

  /// The difference of both motions.
  /// @param own  of the drive, then x, y, yaw of the sensor
  /// @param c    of the drive, then the tracked pose, now and before
  /// @returns    (3) ahead, left, turn in the sensor's frame, scaled
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 3, 1> operator()(
      const std::array<S, SensorOnBase<D>::kParameters.size()>& own,
      const std::array<Q, kConditions.size()>& c) const {
    const PlanarMotion<Q> back = tracked_motion(c.data() + D::kConditions.size()).inverse();
    const PlanarMotion<S> tracked{S(back.x), S(back.y), S(back.cosine), S(back.sine)};
    const Vector3<S> apart = planar_log(PlanarMotion<S>(tracked * this->motion(own, c.data())));
    return {this->translation_scale * apart.x(), this->translation_scale * apart.y(),
            this->rotation_scale * apart.z()};
  }
};

/// A drive against a wall that a laser on the base sees.
template <class D>
struct DriveToWall : SensorOnBase<D> {
  static constexpr auto kConditions = concatenated(D::kConditions, kWall);

  /// The difference of where the wall is and where it should be.
  /// @param own  of the drive, then x, y, yaw of the laser
  /// @param c    of the drive, then angle and distance of the wall, now and before
  /// @returns    (2) distance, angle, scaled
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> operator()(
      const std::array<S, SensorOnBase<D>::kParameters.size()>& own,
      const std::array<Q, kConditions.size()>& c) const {
    using std::cos, std::sin;
    const Q* wall = c.data() + D::kConditions.size();
    const PlanarMotion<S> moved = this->motion(own, c.data());
    const Q swept = wall[0] - wall[2];
    const PlanarMotion<S> seen{S(0.0), S(0.0), S(Q(cos(swept))), S(Q(sin(swept)))};
    const S nearer = moved.x * Q(cos(wall[2])) + moved.y * Q(sin(wall[2]));
    return {this->translation_scale * S(nearer + (wall[1] - wall[3])),
            this->rotation_scale * PlanarMotion<S>(seen * moved).angle()};
  }
};

/// A gyroscope about the vertical: the angle that it measured since the sample before.
struct Gyro {
  static constexpr const char* kUnit = "rad";  ///< of the residual
  static constexpr std::array kParameters = {scale_parameter("scale"),
                                             ParameterInfo{"bias", "rad/s"}};
  /// The integral of its rate, radians, and the time, seconds.
  static constexpr std::array<std::string_view, 4> kConditions = {"gyro_yaw", "time",
                                                                  "before gyro_yaw", "before time"};

  /// What the gyroscope says, less what was seen, within half a turn.
  template <class S, class Q>
  [[nodiscard]] static Eigen::Matrix<S, 1, 1> difference(const std::array<S, 2>& own, const Q* at,
                                                         const Q& seen) {
    using std::atan2, std::cos, std::sin;
    const S apart = own[0] * (at[0] - at[2]) + own[1] * (at[1] - at[3]) - seen;
    return Eigen::Matrix<S, 1, 1>(S(atan2(S(sin(apart)), S(cos(apart)))));
  }
};

}  // namespace detail

/// Two wheels beside each other, against a tracked pose.
struct DifferentialToPose : detail::DriveToPose<DifferentialDrive> {
  static constexpr const char* kType = "differential_to_pose";  ///< name in configurations
};
/// Two wheels beside each other, against a wall.
struct DifferentialToWall : detail::DriveToWall<DifferentialDrive> {
  static constexpr const char* kType = "differential_to_wall";  ///< name in configurations
};
/// Mecanum wheels, against a tracked pose.
struct MecanumToPose : detail::DriveToPose<MecanumDrive> {
  static constexpr const char* kType = "mecanum_to_pose";  ///< name in configurations
};
/// Mecanum wheels, against a wall.
struct MecanumToWall : detail::DriveToWall<MecanumDrive> {
  static constexpr const char* kType = "mecanum_to_wall";  ///< name in configurations
};
/// A wheel that drives and steers, against a tracked pose.
struct TricycleToPose : detail::DriveToPose<TricycleDrive> {
  static constexpr const char* kType = "tricycle_to_pose";  ///< name in configurations
};
/// A wheel that drives and steers, against a wall.
struct TricycleToWall : detail::DriveToWall<TricycleDrive> {
  static constexpr const char* kType = "tricycle_to_wall";  ///< name in configurations
};
/// Reported odometry, against a tracked pose.
struct OdometryToPose : detail::DriveToPose<ReportedOdometry> {
  static constexpr const char* kType = "odometry_to_pose";  ///< name in configurations
};
/// Reported odometry, against a wall.
struct OdometryToWall : detail::DriveToWall<ReportedOdometry> {
  static constexpr const char* kType = "odometry_to_wall";  ///< name in configurations
};

/// True for the type of an error block of a mobile base, in configurations and reports.
[[nodiscard]] inline bool is_base_type(std::string_view type) {
  constexpr std::array<std::string_view, 5> kDrives = {"differential", "mecanum", "tricycle",
                                                       "odometry", "gyro"};
  return std::any_of(kDrives.begin(), kDrives.end(), [&](std::string_view drive) {
    return type.starts_with(drive) &&
           (type.substr(drive.size()) == "_to_pose" || type.substr(drive.size()) == "_to_wall");
  });
}

/// A gyroscope, against a tracked pose.
struct GyroToPose : detail::Gyro {
  static constexpr const char* kType = "gyro_to_pose";  ///< name in configurations
  static constexpr auto kConditions = detail::concatenated(
      Gyro::kConditions, std::array<std::string_view, 2>{"track_yaw", "before track_yaw"});

  /// What the gyroscope says, less what was tracked.
  /// @param own  scale, a factor; bias, rad/s
  /// @param c    integral of the rate and time, now and before; tracked angle, now and before
  /// @returns    (1) radians
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const std::array<S, 2>& own,
                                                  const std::array<Q, 6>& c) const {
    return difference(own, c.data(), Q(c[4] - c[5]));
  }
};
/// A gyroscope, against a wall.
struct GyroToWall : detail::Gyro {
  static constexpr const char* kType = "gyro_to_wall";  ///< name in configurations
  static constexpr auto kConditions = detail::concatenated(
      Gyro::kConditions, std::array<std::string_view, 2>{"wall_angle", "before wall_angle"});

  /// What the gyroscope says, less how far the wall swept to the right.
  /// @param own  scale, a factor; bias, rad/s
  /// @param c    integral of the rate and time, now and before; angle of the wall, now and before
  /// @returns    (1) radians
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const std::array<S, 2>& own,
                                                  const std::array<Q, 6>& c) const {
    return difference(own, c.data(), Q(c[5] - c[4]));
  }
};

}  // namespace kinecal
