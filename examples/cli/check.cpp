// kinecal check: lists every error in the input, and what the samples cannot determine.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <span>
#include <string>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/trust/uncertainty/observability.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// What the samples of each step cannot determine, near the initial values, or near the result if
/// the pose of a frame is not known; empty if they determine all.
std::string not_determined(const Calibration& calibration) {
  const bool searches =
      std::any_of(calibration.steps.begin(), calibration.steps.end(),
                  [](const CalibrationStep& step) { return !step.unknown_frames.empty(); });
  const ParameterTable table = searches ? kinecal::calibrate(calibration).table : calibration.table;
  Eigen::VectorXd values = table.values();
  std::string text;
  for (const CalibrationStep& step : calibration.steps) {
    if (step.problem->num_samples() == 0) continue;
    if (!searches) {
      for (const auto& [parameter, value] : step.assignments) values(parameter) = value;
    }
    const std::span<const double> numbers(values.data(), static_cast<std::size_t>(values.size()));
    text += observability_text(step.name, observability(*step.problem, step.free, numbers), table);
  }
  return text;
}

}  // namespace

int check(const InputOptions& options) {
  InputTexts texts;
  const PreparedCalibration input = read_input(options, texts);
  print(input.diagnostics);
  const std::size_t errors = input.diagnostics.errors.size();
  if (errors > 0) {
    say(stderr, "{} found\n", counted(errors, "error"));
    return kBadInput;
  }
  for (const CalibrationStep& step : input.calibration.steps) {
    if (input.samples.empty()) {
      say("step '{}': fits the robot; samples were not given\n", step.name);
    } else {
      say("step '{}': {}, {}\n", step.name,
          counted(static_cast<std::size_t>(step.problem->num_samples()), "sample"),
          counted(static_cast<std::size_t>(step.free.size()), "free parameter"));
    }
  }
  say("{}", not_determined(input.calibration));
  const std::size_t doubts = input.diagnostics.doubts.size();
  say("no errors found{}\n", doubts == 0 ? "" : ", but " + counted(doubts, "doubt"));
  return kDone;
}

}  // namespace kinecal::cli
