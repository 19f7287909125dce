// A prior on a joint or a frame (outrageous): its parameters should stay small.
//
//   r = ( joint_scale offset,  position_scale (x, y, z),  rotation_scale (a, b, c) )
//
// Source: Fetch paper, III-B, restricting the camera frame
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "kinecal/parameters/parameter_table.hpp"

namespace kinecal {

struct Prior {
  std::string param;            ///< joint or frame
  double joint_scale = 1.0;     ///< 1 / rad or 1 / m
  double position_scale = 1.0;  ///< 1 / m
  double rotation_scale = 1.0;  ///< 1 / rad

  static constexpr int kRows = 7;

  /// The parameter of each row; -1 where the table has none: that row is zero.
  [[nodiscard]] std::array<int, kRows> parameters(const ParameterTable& table) const {
    std::array<int, kRows> rows{table.find(param)};
    for (std::size_t axis = 0; axis < 6; ++axis) {
      rows[axis + 1] = table.find(parameter_name(param, kFrameAxes[axis]));
    }
    return rows;
  }

  [[nodiscard]] std::array<double, kRows> scales() const {
    return {joint_scale,    position_scale, position_scale, position_scale,
            rotation_scale, rotation_scale, rotation_scale};
  }
};

}  // namespace kinecal
