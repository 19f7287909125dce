// kinecal check: lists every error in the input, without solving.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "commands.hpp"
#include "input.hpp"
#include "words.hpp"

namespace kinecal::cli {

int check(const CheckOptions& options) {
  const Input input =
      read_input(options.urdf, options.config, options.samples, options.cameras, options.recorded);
  print(input.diagnostics);
  const std::size_t errors = input.diagnostics.errors.size();
  if (errors > 0) {
    fmt::print(stderr, "{} found\n", counted(errors, "error"));
    return kBadInput;
  }
  for (const CalibrationStep& step : input.calibration.steps) {
    if (input.samples.empty()) {
      fmt::print("step '{}': fits the robot; samples were not given\n", step.name);
    } else {
      fmt::print("step '{}': {}, {}\n", step.name,
                 counted(static_cast<std::size_t>(step.problem->num_samples()), "sample"),
                 counted(static_cast<std::size_t>(step.free.size()), "free parameter"));
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
