// The true position of a joint, for drivers: what calibration.yaml says of a joint and no URDF can
// hold.  Needs only the standard library, so a driver may take this file alone.
//
//   JointErrors elbow;                     // the parameters of joint 'elbow' in calibration.yaml
//   elbow.gear_ratio = 0.0012;
//   const double q = true_position(elbow, {.position = measured});
//
// Leave out `offset` if the URDF already holds it (--offsets origin, or a driver that reads rising).
// What depends on more than the joint itself is summed up in `along`: coupling * position of the other
// joint, link_sag * load of 1 kg at that link, and for a sensor with a lag, lag * velocity.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace kinecal {

/// How a joint differs from its encoder; names and units as in calibration.yaml.
struct JointErrors {
  double offset = 0.0;                                          ///< radians or metres
  double gear_ratio = 0.0;                                      ///< relative
  double eccentric_sin = 0.0, eccentric_cos = 0.0;              ///< radians
  double second_harmonic_sin = 0.0, second_harmonic_cos = 0.0;  ///< radians
  double sag = 0.0;                                             ///< rad/Nm or m/N
  double backlash = 0.0, load_backlash = 0.0;                   ///< radians or metres
};

/// What a driver knows of a joint.
struct MeasuredJoint {
  double position = 0.0;   ///< of the encoder, radians or metres
  double load = 0.0;       ///< torque of gravity about the axis, N m, or force along it, N
  double direction = 0.0;  ///< of the last motion: 1 or -1
  double along = 0.0;      ///< what moves it along: see above; radians or metres
};

/// The true position, radians or metres.
[[nodiscard]] inline double true_position(const JointErrors& e, const MeasuredJoint& m) {
  const double q = m.position, pull = m.load > 0.0 ? 0.5 : m.load < 0.0 ? -0.5 : 0.0;
  return q + e.offset + e.gear_ratio * q + e.eccentric_sin * std::sin(q) +
         e.eccentric_cos * (std::cos(q) - 1.0) + e.second_harmonic_sin * std::sin(2.0 * q) +
         e.second_harmonic_cos * (std::cos(2.0 * q) - 1.0) + e.sag * m.load -
         0.5 * e.backlash * m.direction + e.load_backlash * pull + m.along;
}

}  // namespace kinecal
