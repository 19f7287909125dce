// kinecal check: lists every error in the input, without solving.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "commands.hpp"
#include "input.hpp"

namespace kinecal::cli {

int check(const CheckOptions& options) {
  const Input input =
      read_input(options.urdf, options.config, options.samples, options.cameras, options.recorded);
  print(input.diagnostics);
  const std::size_t errors = input.diagnostics.errors.size();
  if (errors > 0) {
    fmt::print(stderr, "{} error{} found\n", errors, errors == 1 ? "" : "s");
    return kBadInput;
  }
  for (const CalibrationStep& step : input.calibration.steps) {
    if (input.samples.empty()) {
      fmt::print("step '{}': fits the robot; samples were not given\n", step.name);
    } else {
      fmt::print("step '{}': {} samples, {} free parameters\n", step.name,
                 step.problem->num_samples(), step.free.size());
    }
  }
  const std::size_t doubts = input.diagnostics.doubts.size();
  if (doubts == 0) {
    fmt::print("no errors found\n");
  } else {
    fmt::print("no errors found, but {} doubt{}\n", doubts, doubts == 1 ? "" : "s");
  }
  return kDone;
}

}  // namespace kinecal::cli
