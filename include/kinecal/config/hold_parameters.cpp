// Holding parameters: definitions of hold_parameters.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/hold_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

void hold_parameters(Config& config, const std::vector<std::string>& names,
                     Diagnostics& diagnostics) {
  std::set<std::string> free, frames, held;
  for (const StepConfig& step : config.steps) {
    for (const FreeParamConfig& parameter : free_parameters(step)) free.insert(parameter.name);
    for (const FreeFrameConfig& frame : step.free_frames) frames.insert(frame.name);
  }
  for (const std::string& name : names) {
    held.insert(name);
    if (free.contains(name)) continue;
    if (frames.contains(name)) {
      for (const auto axis : kFrameAxes) held.insert(parameter_name(name, axis));
      continue;
    }
    diagnostics.error(config.place,
                      fmt::format("--hold {}: no step frees it{}", name, did_you_mean(name, free)));
  }
  for (StepConfig& step : config.steps) {
    std::erase_if(step.free_params, [&](const auto& param) { return held.contains(param.name); });
    std::erase_if(step.bounds, [&](const auto& bound) { return held.contains(bound.name); });
    for (FreeFrameConfig& frame : step.free_frames) {
      for (std::size_t k = 0; k < 6; ++k) {
        if (held.contains(parameter_name(frame.name, kFrameAxes[k]))) frame.axes[k] = false;
      }
    }
  }
}

}  // namespace kinecal
