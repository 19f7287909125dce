// Definition of reading().
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "kinecal/text/reading.hpp"

namespace kinecal {

KINECAL_INLINE std::string reading(double value, std::string_view unit) {
  double shown = value;
  const char* of = "";
  if (unit == "m") {
    const bool is_large = std::abs(value) >= 1.0;
    shown = is_large ? value : 1e3 * value;
    of = is_large ? " m" : " mm";
  } else if (unit == "rad") {
    shown = value * 180.0 / std::numbers::pi;
    of = " deg";
  } else if (unit == "px") {
    of = " px";
  }
  if (unit == "s") {
    shown = 1e3 * value;
    of = " ms";
  }
  char text[48];
  (void)std::snprintf(text, sizeof text, "%.3g%s", shown, of);
  const bool is_ratio = unit.find('/') != std::string_view::npos;  // of joint models: "rad/Nm"
  return is_ratio ? std::string(text) + " " + std::string(unit) : text;
}

}  // namespace kinecal
