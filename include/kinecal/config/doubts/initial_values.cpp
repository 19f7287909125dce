// Definitions of initial_values.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/initial_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kinecal::detail {

void check_initial_values(const Config& config, Diagnostics& diagnostics) {
  constexpr double kAbsurd = 1e6, kFar = 100.0, kTurn = 2 * std::numbers::pi + 0.01;
  for (const StepConfig& step : config.steps) {
    for (const InitialValueConfig& initial : step.initial_values) {
      if (std::abs(initial.value) <= kAbsurd) continue;
      diagnostics.error(initial.place, fmt::format("initial value of '{}' is {:.6g}; correct it",
                                                   initial.name, initial.value));
    }
    for (const FrameInitialValueConfig& frame : step.frame_initial_values) {
      const double length = frame.xyz.norm(), angle = frame.rpy.cwiseAbs().maxCoeff();
      if (length > kAbsurd || angle > kAbsurd) {
        diagnostics.error(frame.place,
                          fmt::format("initial value of frame '{}' is {:.6g}; correct it",
                                      frame.name, std::max(length, angle)));
      } else if (angle > kTurn) {
        diagnostics.doubt(frame.place, fmt::format("frame '{}' starts at an angle of {:.6g}; is it "
                                                   "in degrees?  Angles must be in radians",
                                                   frame.name, angle));
      } else if (length > kFar) {
        diagnostics.doubt(frame.place, fmt::format("frame '{}' starts {:.6g} m away; is it in "
                                                   "millimetres?  Lengths must be in metres",
                                                   frame.name, length));
      }
    }
  }
}

}  // namespace kinecal::detail
