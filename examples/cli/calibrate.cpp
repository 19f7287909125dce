// kinecal calibrate: samples in, corrected robot out.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/procedure/calibrated_files.hpp"
#include "kinecal/report.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/printable.hpp"
#include "output.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "robot_files.hpp"
#include "scene.hpp"
#include "search.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A line that is overwritten while a step runs.
Progress progress_line() {
  if (!shows_progress()) return {};
  return [](const std::string& step, int iteration, double cost) {
    fmt::print(stderr, "\r{}: iteration {}, cost {:.6g} \033[K", printable(step), iteration, cost);
  };
}

void end_progress_line() {
  if (shows_progress()) fmt::print(stderr, "\r\033[K");
}

bool same_file(const std::filesystem::path& one, const std::filesystem::path& other) {
  std::error_code missing;
  return std::filesystem::equivalent(one, other, missing);
}

/// Copies of the URDF and of the configuration; an input that has the name of its copy, in the same
/// folder, is that copy.
std::vector<OutputFile> copies(const ResultOptions& options, const InputTexts& texts) {
  const std::filesystem::path folder(options.output);
  std::vector<OutputFile> files;
  if (!same_file(folder / kOriginalUrdf, options.urdf)) {
    files.push_back({kOriginalUrdf, texts.urdf_text});
  }
  if (!texts.found_config.empty()) {
    files.push_back({kConfigCopy, texts.found_config});
  } else if (!same_file(folder / kConfigCopy, options.config)) {
    files.push_back({kConfigCopy, texts.config_text});
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

namespace {

OffsetStyle offset_style(const ResultOptions& options) {
  const std::map<std::string, OffsetStyle> styles = {{"", OffsetStyle::as_read},
                                                     {"origin", OffsetStyle::origin},
                                                     {"rising", OffsetStyle::rising},
                                                     {"ros2_control", OffsetStyle::ros2_control}};
  return styles.at(options.offsets);
}

}  // namespace

void judge_files_of(const ResultOptions& options, const Robot& robot,
                    CalibrationOptions& calibrating) {
  const std::map<std::string, std::optional<Reader>> readers = {{"", std::nullopt},
                                                                {"driver", Reader::driver},
                                                                {"urdf", Reader::urdf},
                                                                {"origins", Reader::origins}};
  calibrating.offsets = offset_style(options);
  calibrating.in_servos = zeros_in_servos(options.robot_files, robot);
  calibrating.reader = readers.at(options.reader);
}

ResultFileOptions file_options(const ResultOptions& options, const Robot& robot) {
  ResultFileOptions files;
  files.offsets = offset_style(options);
  files.in_servos = zeros_in_servos(options.robot_files, robot);
  if (options.upstream_names) {
    files.date = fmt::format("{:%Y_%m_%d_%H_%M_%S}", fmt::localtime(std::time(nullptr)));
  }
  return files;
}

std::vector<OutputFile> files_of(const ResultOptions& options, const InputTexts& texts,
                                 const CalibratedRobot& calibrated) {
  std::vector<OutputFile> files = calibrated_files(
      calibrated, file_options(options, calibrated.setup.robot), copies(options, texts));
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

/// The inputs as `kinecal plan` takes them; empty if it needs more: a URDF, or intrinsics.
ShellCommand inputs_of_plan(const CalibrateOptions& options, const InputTexts& texts) {
  InputOptions of = options;
  if (!texts.found_config.empty() && !options.output.empty()) {
    of.config = (std::filesystem::path(options.output) / kConfigCopy).string();
  }
  const bool is_complete = !of.urdf.empty() && !of.config.empty() && of.cameras.empty();
  return is_complete ? input_options(of) : ShellCommand();
}

/// Checks before the work begins that the results can be written.
std::optional<OutputFolder> output_folder(const CalibrateOptions& options) {
  if (options.output.empty() && !options.dry_run) {
    throw InputError("--output is required (or --dry-run)");
  }
  if (options.output == "-")
    throw InputError("--output: '-' is no folder, and the results are several files");
  check_reports(options);
  if (!options.scene.empty()) check_scene(options);
  if (options.dry_run) return std::nullopt;
  check_results(options);
  return std::optional<OutputFolder>(std::in_place, options.output);
}

/// Calibrates and judges, with a line of progress on a terminal.
CalibratedRobot fit_and_judge(const CalibrateOptions& options, PreparedCalibration prepared,
                              InputTexts& texts) {
  std::optional<ProgressLine> line(std::in_place);
  CalibrationOptions calibrating = calibration_options(options);
  calibrating.solving = solve_options(options);
  calibrating.solving.meter = line->meter();
  calibrating.folds = options.folds;
  calibrating.between = options.between;
  calibrating.keep_outliers = options.keep_outliers;
  judge_files_of(options, prepared.robot, calibrating);
  calibrating.progress = progress_line();
  CalibratedRobot calibrated = calibrate_robot(std::move(prepared), calibrating);
  line.reset();
  end_progress_line();
  if (calibrated.robot_search) {
    texts.found_config = found_config(calibrated);
    print(calibrated.setup.diagnostics);
    if (!options.manner.quiet && !options.manner.json) {
      show(search_summary(calibrated) + "\n", options.manner);
    }
  }
  calibrated.call = {options.command, inputs_of_plan(options, texts),
                     options.dry_run ? "" : options.output, KINECAL_VERSION,
                     read_files(options, texts)};
  return calibrated;
}

void show_findings(const Findings& findings, const Manner& manner) {
  if (manner.json) {
    say("{}", json_report(findings));
  } else if (!manner.quiet) {
    show(manner.verbose ? summary_text(findings) : findings_text(findings), manner);
  }
  std::fflush(stdout);
}

/// "100 samples, 0.17 s: reading 0.03 s, solving 0.0004 s (...), judging 0.13 s, writing 0.01 s"
std::string times_text(std::size_t samples, const CalibrationResult& result, double reading,
                       double fitting, double writing) {
  double solving = 0.0;
  for (const StepResult& step : result.steps) solving += step.seconds;
  return fmt::format("{}, {:.3f} s: reading {:.3f} s, {}, judging {:.3f} s, writing {:.3f} s\n",
                     counted(samples, "sample"), reading + fitting + writing, reading,
                     solving_text(result), std::max(0.0, fitting - solving), writing);
}

/// The last line: the verdict, and where the results are.
std::string last_line(const Findings& findings, const CalibrateOptions& options,
                      std::size_t files) {
  std::string text = findings_line(findings);
  if (files > 0) text += fmt::format(" · {} in {}", counted(files, "file"), options.output);
  for (const std::string& report : options.reports) text += " · " + report;
  if (!options.scene.empty()) text += " · " + options.scene;
  return text + "\n";
}

}  // namespace

int calibrate(const CalibrateOptions& options) {
  set_progress(!options.manner.quiet);
  const Clock::time_point start = Clock::now();
  std::optional<OutputFolder> folder = output_folder(options);
  InputTexts texts;
  PreparedCalibration prepared = read_input(options, texts);
  print(prepared.diagnostics);
  if (!prepared.diagnostics.errors.empty()) return kBadInput;
  if (folder) check_robot_files(options, prepared.robot, texts);
  prepared.diagnostics.notes.clear();  // they are printed
  prepared.diagnostics.warnings.clear();
  const double reading = seconds_since(start);

  const CalibratedRobot calibrated = fit_and_judge(options, std::move(prepared), texts);
  if (found_nothing(calibrated)) {
    say(stderr,
        "error: nothing is free, and these samples support no parameter: no results written\n");
    return kNotUsable;
  }
  const double fitting = seconds_since(start) - reading;
  const Findings& findings = calibrated;
  const Manner& manner = options.manner;
  show_findings(findings, manner);

  write_reports(options, texts, calibrated);
  if (!options.scene.empty()) write_scene_file(options.scene, calibrated, options.mesh_paths);
  const Robot& robot = calibrated.setup.robot;
  std::vector<OutputFile> files;
  if (folder && calibrated.is_usable()) {
    files = files_of(options, texts, calibrated);
    const RobotFiles others =
        robot_files(options, robot, texts, findings.result.table, files.front().content);
    folder->write(files, options.force ? Existing::replaced : Existing::kept);
    write(others);
  }
  const double writing = seconds_since(start) - reading - fitting;
  if (!manner.json && !manner.quiet) {
    show("\n" + times_text(calibrated.setup.samples.size(), findings.result, reading, fitting,
                           writing),
         manner);
  }
  if (!manner.json) show(last_line(findings, options, files.size()), manner);
  if (calibrated.is_usable()) return kDone;
  say(stderr, "error: calibration of step '{}' failed, no results written: {}\n",
      findings.result.steps.empty() ? "" : findings.result.steps.back().name,
      findings.judgement.reasons.front());
  return kNotUsable;
}

}  // namespace kinecal::cli
