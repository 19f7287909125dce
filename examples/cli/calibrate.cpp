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
#include "fit.hpp"
#include "input.hpp"
#include "kinecal/config/doubts/judge_causes.hpp"
#include "kinecal/report.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/printable.hpp"
#include "kinecal/tools/identify/would_help.hpp"
#include "kinecal/trust/speed_limit.hpp"
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
std::vector<OutputFile> copies(const ResultOptions& options, const Input& input) {
  const std::filesystem::path folder(options.output);
  std::vector<OutputFile> files;
  if (!same_file(folder / kOriginalUrdf, options.urdf)) {
    files.push_back({kOriginalUrdf, input.urdf_text});
  }
  if (!input.found_config.empty()) {
    files.push_back({kConfigCopy, input.found_config});
  } else if (!same_file(folder / kConfigCopy, options.config)) {
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

ResultFileOptions file_options(const ResultOptions& options, const Robot& robot) {
  ResultFileOptions files;
  const std::map<std::string, OffsetStyle> styles = {{"", OffsetStyle::as_read},
                                                     {"origin", OffsetStyle::origin},
                                                     {"rising", OffsetStyle::rising},
                                                     {"ros2_control", OffsetStyle::ros2_control}};
  files.offsets = styles.at(options.offsets);
  files.in_servos = zeros_in_servos(options.robot_files, robot);
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

/// Says what does not read the zeros that were written, if the URDF had none of this kind before.
std::string offsets_text(const ResultOptions& options, const Input& input,
                         const std::vector<JointPatch>& patches) {
  if (!options.offsets.empty() ||
      !goes_into_rising(input.urdf_text, input.urdf, input.robot, patches)) {
    return "";
  }
  return "\nzeros of joints are in <calibration rising> of the URDF, which robot_state_publisher, "
         "MoveIt and most drivers do not read; --offsets origin puts them into the origins, which "
         "all read\n";
}

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
ShellCommand inputs_of_plan(const CalibrateOptions& options, const Input& input) {
  InputOptions of = options;
  if (input.is_searched && !options.output.empty()) {
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

/// How fast is still good, if the configuration has a lag.
std::vector<std::string> how_fast(const Fit& fitted) {
  const CalibrationResult& result = fitted.findings.result;
  if (!result.converged) return {};
  const CalibrationStep& last = fitted.calibration.steps.back();
  const Eigen::VectorXd values = result.table.values();
  std::vector<std::string> sentences;
  for (const SpeedLimit& limit :
       speed_limits(*last.problem, last.free,
                    {values.data(), static_cast<std::size_t>(values.size())}, fitted.samples)) {
    sentences.push_back(limit.text());
  }
  return sentences;
}

/// Calibrates and judges, with a line of progress on a terminal; nothing if nothing is free and the samples support nothing.
std::optional<Fit> fit_and_judge(const CalibrateOptions& options, Input& input) {
  std::optional<ProgressLine> line(std::in_place);
  SolveOptions solving = solve_options(options);
  solving.meter = line->meter();
  Fit fitted;
  if (input.is_searched) {
    SearchedFit found = search_and_fit(input, options, false, progress_line(), solving);
    end_progress_line();
    print(input.diagnostics);
    if (!options.manner.quiet && !options.manner.json) {
      show(search_summary(found, input) + "\n", options.manner);
    }
    if (found.is_empty()) return std::nullopt;
    input.found_config = std::move(found.config);
    fitted = std::move(found.fit);
  } else {
    fitted = fit(input, std::move(input.calibration), options, progress_line(), solving);
  }
  line.reset();
  end_progress_line();
  judge_causes(
      {input.config, input.robot, input.urdf_text, input.urdf, fitted.samples, fitted.calibration},
      fitted.findings);
  if (!input.is_searched) {  // else it is named already
    const WouldHelp help = would_help(input.config, input.robot, fitted.samples, fitted.calibration,
                                      fitted.findings.result);
    fitted.findings.helps = help.sentences;
    fitted.findings.helps_leave = help.left;
    judge_help(help, fitted.findings.judgement);
  }
  fitted.findings.speeds = how_fast(fitted);
  fitted.findings.call = {options.command, inputs_of_plan(options, input),
                          options.dry_run ? "" : options.output, KINECAL_VERSION,
                          read_files(options, input)};
  return fitted;
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
  Input input = read_input(options);
  print(input.diagnostics);
  if (!input.diagnostics.errors.empty()) return kBadInput;
  if (folder) check_robot_files(options, input);
  const double reading = seconds_since(start);

  const std::optional<Fit> fit_of_input = fit_and_judge(options, input);
  if (!fit_of_input) {
    say(stderr,
        "error: nothing is free, and these samples support no parameter: no results written\n");
    return kNotUsable;
  }
  const Fit& fitted = *fit_of_input;
  const double fitting = seconds_since(start) - reading;
  const Findings& findings = fitted.findings;
  const Manner& manner = options.manner;
  show_findings(findings, manner);

  write_reports(options, input, fitted);
  if (!options.scene.empty()) write_scene_file(options.scene, input, fitted, options.mesh_paths);
  const bool is_usable = findings.judgement.verdict != Grade::do_not_use;
  const ResultFileOptions how = file_options(options, input.robot);
  std::vector<OutputFile> files;
  if (folder && is_usable) {
    files = with_copies(options, input,
                        output_files(input.robot, {input.urdf, input.urdf_text}, fitted.calibration,
                                     findings, fitted.samples, how));
    const RobotFiles others =
        robot_files(options, input, findings.result.table, files.front().content);
    folder->write(files, options.force ? Existing::replaced : Existing::kept);
    write(others);
  }
  const double writing = seconds_since(start) - reading - fitting;
  if (!manner.json && !manner.quiet) {
    if (!files.empty()) {
      show(offsets_text(options, input,
                        joint_patches(input.robot, findings.result.table, how.in_servos)),
           manner);
    }
    show("\n" + times_text(input.samples.size(), findings.result, reading, fitting, writing),
         manner);
  }
  if (!manner.json) show(last_line(findings, options, files.size()), manner);
  if (is_usable) return kDone;
  say(stderr, "error: calibration of step '{}' failed, no results written: {}\n",
      findings.result.steps.empty() ? "" : findings.result.steps.back().name,
      findings.judgement.reasons.front());
  return kNotUsable;
}

}  // namespace kinecal::cli
