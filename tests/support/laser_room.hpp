// A laser scanner that tilts in the corner of a room: its URDF, and the ranges that it measures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::test {

/// Floor, a wall ahead and one to the left are one link, whose inner faces are z = 0, x = 2 and y = 1.5.
inline const char* const kLaserRoomUrdf = R"(<robot name="room">
<link name="base"/><link name="tilted"/><link name="laser"/>
<link name="room">
<visual><origin xyz="0 0 -0.1"/><geometry><box size="8 8 0.2"/></geometry></visual>
<visual><origin xyz="2.1 0 1"/><geometry><box size="0.2 8 4"/></geometry></visual>
<visual><origin xyz="0 1.6 1"/><geometry><box size="8 0.2 4"/></geometry></visual>
</link>
<joint name="room_joint" type="fixed"><parent link="base"/><child link="room"/></joint>
<joint name="tilt" type="revolute"><parent link="base"/><child link="tilted"/><origin xyz="0 0 1"/>
<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="2"/></joint>
<joint name="laser_joint" type="fixed"><parent link="tilted"/><child link="laser"/>
<origin xyz="0.05 0 0.03"/></joint>
</robot>
)";

/// Errors of the robot: what a calibration finds.
struct LaserErrors {
  double tilt = 0.0;                                ///< offset of the joint, radians
  Vector3<double> shift = Vector3<double>::Zero();  ///< of the laser's frame, metres
  Vector3<double> turn = Vector3<double>::Zero();   ///< of it, rotation vector, radians
};

/// base_T_laser of a measured position of the joint, radians.
inline Pose<double> laser_pose(double tilt, const LaserErrors& errors = {}) {
  const Pose<double> joint{exp(Vector3<double>(0.0, tilt + errors.tilt, 0.0)),
                           Vector3<double>(0.0, 0.0, 1.0)};
  const Pose<double> origin{Matrix3<double>::Identity(), Vector3<double>(0.05, 0.0, 0.03)};
  return joint * origin * Pose<double>{exp(errors.turn), errors.shift};
}

/// Distance of a point to the nearest face of the room, metres.
inline double off_room(const Vector3<double>& p_base) {
  return std::min({std::abs(p_base.z()), std::abs(2.0 - p_base.x()), std::abs(1.5 - p_base.y())});
}

/// The range of a beam, metres; infinite where it leaves the room.
/// @param angle  of the beam, to the left of the laser's x axis
inline double room_range(const Pose<double>& base_T_laser, double angle) {
  const Vector3<double> ray =
      base_T_laser.rotation * Vector3<double>(std::cos(angle), std::sin(angle), 0.0);
  const Vector3<double>& from = base_T_laser.translation;
  double nearest = std::numeric_limits<double>::infinity();
  for (const double r :
       {-from.z() / ray.z(), (2.0 - from.x()) / ray.x(), (1.5 - from.y()) / ray.y()}) {
    if (r > 0.0) nearest = std::min(nearest, r);
  }
  return nearest;
}

/// Samples of scans at rest, from tilted down to tilted up.
/// @param noise  of a range, metres
/// @param lost   share of the beams that something in the room stops half way
inline std::vector<Sample> laser_samples(const LaserErrors& errors, double noise,
                                         double lost = 0.0) {
  std::mt19937 engine(1);
  std::normal_distribution<double> error(0.0, 1.0);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  std::vector<Sample> samples;
  for (int s = 0; s < 12; ++s) {
    Sample& sample = samples.emplace_back();
    sample.source = "scan " + std::to_string(s);
    sample.joint_names = {"tilt"};
    sample.joint_positions = {-0.3 + 0.1 * s};
    Observation seen{"laser", {}, {}};
    for (double angle = -1.2; angle < 1.5; angle += 0.03) {
      double range = room_range(laser_pose(sample.joint_positions[0], errors), angle);
      if (range > 3.5) continue;
      range = chance(engine) < lost ? 0.5 * range : range + noise * error(engine);
      seen.features.push_back(
          {"laser", Vector3<double>(range * std::cos(angle), range * std::sin(angle), 0.0)});
    }
    sample.observations.push_back(std::move(seen));
  }
  return samples;
}

}  // namespace kinecal::test
