// What all batches of an evaluation share of a sensor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/kinematics/twist_walker.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/parameters/own_parameters.hpp"
#include "kinecal/problem/mounted_sensor.hpp"

namespace kinecal::detail {

/// State of a sensor that all batches share: the corrections of its chains, its parameters and the
/// columns of the Jacobian.
struct SensorState {
  std::vector<Corrections<double>> corrections;    ///< of each chain
  std::vector<std::vector<JointIndices>> columns;  ///< of the joints of each chain
  std::vector<TwistColumns> twist_columns;         ///< of each chain
  std::vector<std::size_t> effects;                ///< of each chain: most_effects()
  OwnParameters own;                               ///< of the sensor itself
  bool placed;                                     ///< a block uses more of it than predictions

  /// @param free  the columns of the Jacobian
  SensorState(const MountedSensor& sensor, const FreeSet& free, bool is_placed);

  /// Takes over new values.
  /// @param values  of all parameters of the table
  void set(const MountedSensor& sensor, ParameterValues values);
};

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/evaluation/views/sensor_state.ipp"
#endif
