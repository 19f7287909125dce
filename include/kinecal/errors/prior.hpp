// A prior (outrageous): keeps a joint, a frame or a single parameter near a mean, zero by default.
//
//   r = ( joint_scale value,  position_scale (x, y, z),  rotation_scale (a, b, c) )
//
// of the differences from the mean.  `value` is a joint's offset or any single parameter: of a
// sensor (camera_fx), an error block (bar_radius) or a joint model (elbow_gear_ratio).
//
// Source: Fetch paper, III-B, the prior on the camera frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "kinecal/parameters/parameter_table.hpp"

namespace kinecal {

/// Names of the means of a prior, in the order of Prior::mean: keys of configurations.
inline constexpr std::array<const char*, 7> kPriorMeans = {"mean",   "mean_x", "mean_y", "mean_z",
                                                           "mean_a", "mean_b", "mean_c"};

/// Keeps a joint, a frame or a single parameter near a mean.
struct Prior {
  std::string param;            ///< name of the joint, frame or parameter
  double joint_scale = 1.0;     ///< of a joint or parameter: 1 / its unit
  double position_scale = 1.0;  ///< 1 / m
  double rotation_scale = 1.0;  ///< 1 / rad
  /// Expected values: value x y z a b c; unit of the parameter, metres, radians.
  std::array<double, 7> mean = {};

  static constexpr int kRows = 7;  ///< residuals: value x y z a b c

  /// Table index of the parameter of each residual; -1 if the table does not have it: its residual
  /// is zero.
  [[nodiscard]] std::array<int, kRows> parameters(const ParameterTable& table) const {
    std::array<int, kRows> rows{table.find(param)};
    for (std::size_t axis = 0; axis < 6; ++axis) {
      rows[axis + 1] = table.find(parameter_name(param, kFrameAxes[axis]));
    }
    return rows;
  }

  /// (7) factor of each residual.
  [[nodiscard]] std::array<double, kRows> scales() const {
    return {joint_scale,    position_scale, position_scale, position_scale,
            rotation_scale, rotation_scale, rotation_scale};
  }
};

}  // namespace kinecal
