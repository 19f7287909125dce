// A mobile base with errors, simulated.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/study/simulated_base.hpp"

namespace kinecal::test {

/// Errors of 2 % of the track width, both wheels and the gyroscope, and a bias of the gyroscope of 2 mrad/s.
inline SimulatedBase wrong_base() {
  SimulatedBase base;
  base.track_width_scale = 1.02;
  base.left_rollout_scale = base.right_rollout_scale = 0.98;
  base.imu_scale = 0.98;
  base.imu_bias = 0.002;
  return base;
}

}  // namespace kinecal::test
