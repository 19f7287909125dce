// kinecal calibrate: samples in, corrected robot out.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/chrono.h>
#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <optional>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/io/results/result_files.hpp"
#include "kinecal/report.hpp"

namespace kinecal::cli {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A line that is overwritten while a step runs; only on a terminal.
Progress progress_line() {
  if (isatty(STDERR_FILENO) == 0) return {};
  return [](const std::string& step, int iteration, double cost) {
    fmt::print(stderr, "\r{}: iteration {}, cost {:.6g} \033[K", step, iteration, cost);
  };
}

void end_progress_line() {
  if (isatty(STDERR_FILENO) != 0) fmt::print(stderr, "\r\033[K");
}

ResultFileOptions file_options(const CalibrateOptions& options) {
  ResultFileOptions files;
  files.offsets = options.offsets == "origin" ? OffsetStyle::origin : OffsetStyle::rising;
  if (options.upstream_names) {
    files.date = fmt::format("{:%Y_%m_%d_%H_%M_%S}", fmt::localtime(std::time(nullptr)));
  }
  return files;
}

std::vector<Observability> observe(const Calibration& calibration,
                                   const CalibrationResult& result) {
  const Eigen::VectorXd values = result.table.values();
  std::vector<Observability> all;
  for (const CalibrationStep& step : calibration.steps) {
    all.push_back(observability(step.problem, step.free,
                                {values.data(), static_cast<std::size_t>(values.size())}));
  }
  return all;
}

void print_doubts(const Input& input, const CalibrationResult& result,
                  const std::vector<Observability>& observability) {
  for (std::size_t s = 0; s < observability.size(); ++s) {
    const std::string text =
        observability_text(input.calibration.steps[s].name, observability[s], result.table);
    if (!text.empty()) fmt::print(stderr, "warning: {}\n", text);
  }
  for (const std::string& line : active_bounds(input.calibration, result)) {
    fmt::print(stderr, "warning: {}\n", line);
  }
  for (const std::string& line : suspicious_values(result)) {
    fmt::print(stderr, "warning: {}\n", line);
  }
}

/// Results must not replace what they were made from.
void check_targets(const CalibrateOptions& options, const std::filesystem::path& folder,
                   const std::vector<OutputFile>& files) {
  std::vector<std::string> inputs = options.samples;
  inputs.insert(inputs.end(), {options.urdf, options.config});
  for (const OutputFile& file : files) {
    for (const std::string& input : inputs) {
      std::error_code missing;
      if (!std::filesystem::equivalent(folder / file.name, input, missing)) continue;
      throw OutputError((folder / file.name).string() +
                        ": would replace an input; choose another --output");
    }
  }
}

SolveOptions solve_options(const CalibrateOptions& options) {
  SolveOptions solving;
  solving.threads = options.threads;
  if (options.cost == "stacked") solving.form = CostForm::stacked;
  return solving;
}

void print_result(const Input& input, const CalibrationResult& result) {
  fmt::print("Robot '{}', {} samples\n{}\n", input.robot.name(), input.samples.size(),
             step_lines(result));
  fmt::print("Error blocks, before -> after (rms of components; median and max of features)\n{}\n",
             error_block_table(result));
  fmt::print("Parameters\n{}\n", parameter_table(result));
}

}  // namespace

int calibrate(const CalibrateOptions& options) {
  const Clock::time_point start = Clock::now();
  const Input input = read_input(options.urdf, options.config, options.samples);
  print(input.diagnostics);
  if (!input.diagnostics.errors.empty()) return kBadInput;

  // Found out before the work is done: whether the results can be written.
  std::optional<OutputFolder> folder;
  if (!options.dry_run) folder.emplace(options.output);
  const double reading = seconds_since(start);
  const CalibrationResult result =
      kinecal::calibrate(input.calibration, progress_line(), solve_options(options));
  end_progress_line();
  const std::vector<Observability> observability = observe(input.calibration, result);
  const bool ran = !result.steps.empty() && result.steps.back().iterations > 0;
  if (result.converged || ran) {
    print_result(input, result);
    std::fflush(stdout);
    print_doubts(input, result, observability);
  }
  if (!result.converged) {
    fmt::print(stderr, "error: step '{}' is not calibrated, nothing written: {}\n",
               result.steps.back().name, result.termination);
    return kNotConverged;
  }
  if (folder) {
    std::vector<OutputFile> files =
        result_files(input.robot, input.urdf_text, options.urdf, input.calibration, result,
                     input.samples, file_options(options));
    files.push_back({"report.json", json_report(result, observability)});
    check_targets(options, folder->path(), files);
    folder->write(files);
    for (const OutputFile& file : files) {
      fmt::print("wrote {}\n", (folder->path() / file.name).string());
    }
  }
  fmt::print("{} samples, {:.3f} s: reading {:.3f} s, {}\n", input.samples.size(),
             seconds_since(start), reading, solving_text(result));
  return kDone;
}

}  // namespace kinecal::cli
