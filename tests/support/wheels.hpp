// An error block without a sensor: what wheels turned, against the way that was tracked.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "kinecal/errors/error_block.hpp"

namespace kinecal::test {

/// Two wheels beside each other.  Conditions: the way and the turn since the sample before, metres and radians.
struct Wheels {
  static constexpr const char *kType = "wheels", *kUnit = "m";
  static constexpr std::array kParameters = {ParameterInfo{"left", "m", 0.1},
                                             ParameterInfo{"right", "m", 0.1},
                                             ParameterInfo{"track", "m", 0.5}};
  static constexpr std::array<std::string_view, 6> kConditions = {
      "way", "turn", "wheel_left", "wheel_right", "before wheel_left", "before wheel_right"};

  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> operator()(const std::array<S, 3>& own,
                                                  const std::array<Q, 6>& c) const {
    const S left = own[0] * (c[2] - c[4]), right = own[1] * (c[3] - c[5]);
    return {0.5 * (left + right) - c[0], right - left - own[2] * c[1]};
  }
};
}  // namespace kinecal::test
