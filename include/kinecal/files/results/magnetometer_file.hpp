// The hard and soft iron of a magnetometer: magnetometer_calibration.yaml, under the keys that magnetometer_calibration of
// robot_calibration prints.
//
//   mag_bias_x: 1.23e-05  # +- 2e-07           tesla: subtract it from a reading
//   mag_field: 4.9e-05  # +- 1e-07             tesla: the strength of the field
//   mag_soft_iron: [...]                       (3 x 3) by rows, if it was free: multiply what is left of the reading by it
//
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace kinecal {

struct Calibration;
class ParameterTable;

/// The content of the file; empty if no error block is of a magnetometer.  Of two blocks, the first counts.
/// @param deviations  standard deviations by table index; infinite: not determined
[[nodiscard]] std::string magnetometer_yaml(const Calibration& calibration,
                                            const ParameterTable& table,
                                            const std::map<int, double>& deviations);

}  // namespace kinecal
