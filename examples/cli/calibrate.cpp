// kinecal calibrate: samples in, corrected robot out.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/chrono.h>
#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <optional>
#include <utility>

#include "commands.hpp"
#include "fit.hpp"
#include "input.hpp"
#include "kinecal/config/doubts/judge_causes.hpp"
#include "kinecal/report.hpp"
#include "kinecal/text/counted.hpp"
#include "output.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "scene.hpp"

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

bool same_file(const std::filesystem::path& one, const std::filesystem::path& other) {
  std::error_code missing;
  return std::filesystem::equivalent(one, other, missing);
}

/// Copies of the URDF and of the configuration; an input that has the name of its copy, in the same
/// folder, is that copy.
std::vector<OutputFile> copies(const ResultOptions& options, const Input& input) {
  const std::filesystem::path folder(options.output);
  std::vector<OutputFile> files;
  if (!same_file(folder / kOriginalUrdf, options.urdf)) {
    files.push_back({kOriginalUrdf, input.urdf_text});
  }
  if (!same_file(folder / kConfigCopy, options.config)) {
    files.push_back({kConfigCopy, input.config_text});
  }
  return files;
}

/// Results must not replace their own input, and other files only on demand.
void check_targets(const ResultOptions& options, const std::filesystem::path& folder,
                   const std::vector<OutputFile>& files) {
  std::vector<std::string> inputs = options.samples;
  inputs.insert(inputs.end(), {options.urdf, options.config});
  for (const std::string& camera : options.cameras) {
    const std::string file = camera.substr(camera.find('=') + 1);
    inputs.insert(inputs.end(), {file, file.substr(0, file.rfind(':'))});
  }
  for (const OutputFile& file : files) {
    for (const std::string& input : inputs) {
      if (!same_file(folder / file.name, input)) continue;
      throw OutputError((folder / file.name).string() +
                        ": would replace an input; choose another --output");
    }
    const auto there = std::filesystem::symlink_status(folder / file.name);
    const bool is_file =
        std::filesystem::is_regular_file(there) || std::filesystem::is_symlink(there);
    if (options.force || !is_file) continue;
    throw OutputError((folder / file.name).string() +
                      ": exists; use --force to replace it, or choose another --output");
  }
}

}  // namespace

void check_results(const ResultOptions& options) {
  std::vector<OutputFile> files = copies(options, {});
  files.push_back({"report.json", ""});
  if (!options.upstream_names)
    files.insert(files.end(), {{"calibrated.urdf", ""}, {"calibration.yaml", ""}});
  check_targets(options, options.output, files);
  const OutputFolder can_be_written(options.output);
}

ResultFileOptions file_options(const ResultOptions& options) {
  ResultFileOptions files;
  files.offsets = options.offsets == "origin" ? OffsetStyle::origin : OffsetStyle::rising;
  if (options.upstream_names) {
    files.date = fmt::format("{:%Y_%m_%d_%H_%M_%S}", fmt::localtime(std::time(nullptr)));
  }
  return files;
}

std::vector<OutputFile> with_copies(const ResultOptions& options, const Input& input,
                                    std::vector<OutputFile> files) {
  for (OutputFile& copy : copies(options, input)) files.push_back(std::move(copy));
  check_targets(options, options.output, files);
  return files;
}

namespace {

/// The scene must not replace an input or a report, and another file only on demand.
void check_scene(const CalibrateOptions& options) {
  std::vector<std::string> inputs = options.samples;
  inputs.insert(inputs.end(), {options.urdf, options.config});
  inputs.insert(inputs.end(), options.reports.begin(), options.reports.end());
  check_output(options.scene, inputs, options.force);
}

SolveOptions solve_options(const CalibrateOptions& options) {
  SolveOptions solving;
  solving.threads = options.threads;
  solving.random_starts = options.starts;
  if (options.cost == "stacked") solving.form = CostForm::stacked;
  return solving;
}

}  // namespace

int calibrate(const CalibrateOptions& options) {
  if (options.output.empty() && !options.dry_run) {
    throw InputError("--output is required (or --dry-run)");
  }
  if (!options.dry_run) check_results(options);
  check_reports(options);
  if (!options.scene.empty()) check_scene(options);
  const Clock::time_point start = Clock::now();
  Input input = read_input(options);
  print(input.diagnostics);
  if (!input.diagnostics.errors.empty()) return kBadInput;

  // Checks that the results can be written before the work begins.
  std::optional<OutputFolder> folder;
  if (!options.dry_run) folder.emplace(options.output);
  const double reading = seconds_since(start);
  std::optional<ProgressLine> line(std::in_place);
  SolveOptions solving = solve_options(options);
  solving.meter = line->meter();
  Fit fitted = fit(input, std::move(input.calibration), options, progress_line(), solving);
  line.reset();
  end_progress_line();
  Findings& findings = fitted.findings;
  const CalibrationResult& result = findings.result;
  judge_causes(
      {input.config, input.robot, input.urdf_text, input.urdf, fitted.samples, fitted.calibration},
      findings);
  fmt::print("{}", summary_text(findings));
  std::fflush(stdout);
  write_reports(options, input, fitted);
  if (!options.scene.empty()) write_scene_file(options.scene, input, fitted, options.mesh_paths);
  if (findings.judgement.verdict == Grade::do_not_use) {
    fmt::print(stderr, "error: calibration of step '{}' failed, no results written: {}\n",
               result.steps.empty() ? "" : result.steps.back().name,
               findings.judgement.reasons.front());
    return kNotUsable;
  }
  if (folder) {
    std::vector<OutputFile> files =
        output_files(input.robot, {input.urdf, input.urdf_text}, fitted.calibration, findings,
                     fitted.samples, file_options(options));
    write(*folder, with_copies(options, input, std::move(files)));
  }
  fmt::print("{}, {:.3f} s: reading {:.3f} s, {}\n", counted(input.samples.size(), "sample"),
             seconds_since(start), reading, solving_text(result));
  return kDone;
}

}  // namespace kinecal::cli
