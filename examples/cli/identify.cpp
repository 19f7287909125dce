// kinecal identify: finds out what is wrong with a robot.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/results/standard_output.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/report/findings.hpp"
#include "kinecal/text/name_list.hpp"
#include "kinecal/tools/identify/tell_apart.hpp"
#include "output_file.hpp"
#include "report.hpp"
#include "search.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// The same inputs and reports, for the calibration with what was found.
CalibrateOptions for_calibration(const IdentifyOptions& options) {
  CalibrateOptions all;
  static_cast<InputOptions&>(all) = options;
  all.nothing_free = NothingFree::is_allowed;  // it always searches
  all.reports = options.reports;
  all.command = options.command;
  return all;
}

/// True if a command that is to be pasted can read these inputs and this output.
bool are_files(const std::vector<std::string>& inputs, const std::string& output) {
  return std::none_of(inputs.begin(), inputs.end(), detail::is_stream) &&
         !is_standard_output(output);
}

/// The name of a candidate for --tell-apart: one of several parameters is that of its first, that of a frame without its
/// axes.
std::string plain_name(const std::string& name) {
  return name.substr(0, name.find_first_of(",:"));
}

/// The poses that would decide between what was freed and the first that looks alike, as a command; empty if nothing does.
std::string deciding_command(const CalibratedRobot& found, const InputOptions& next) {
  if (next.urdf.empty()) return "";
  for (const ReportedSearchStep& step : found.search.steps) {
    const auto other =
        std::find_if(step.alike.begin(), step.alike.end(), [&](const std::string& name) {
          return std::find(step.inseparable.begin(), step.inseparable.end(), name) ==
                 step.inseparable.end();
        });
    if (other == step.alike.end()) continue;
    const std::string names =
        list_entry(plain_name(step.freed)) + "," + list_entry(plain_name(*other));
    InputOptions inputs = next;
    if (!sees_everywhere(found.robot_search->config))
      inputs.samples.clear();  // views are generated
    inputs.cameras.clear();
    const ShellCommand command = ShellCommand{"kinecal", "select-poses"}
                                     .add(input_options(inputs))
                                     .add_option("--tell-apart", {names})
                                     .add({"--count", "10", "-o", "poses.yaml"});
    return "which poses would decide between what explains the same:\n  " + command.str() + "\n";
  }
  return "";
}

}  // namespace

int identify(const IdentifyOptions& options) {
  std::vector<std::string> inputs = options.samples;
  inputs.insert(inputs.end(), {options.urdf, options.config});
  check_output(options.output, inputs, options.force);
  CalibrateOptions calibration = for_calibration(options);
  check_reports(calibration);
  InputTexts texts;
  PreparedCalibration prepared = read_input(calibration, texts);
  print_or_throw(prepared.diagnostics);
  prepared.diagnostics.notes.clear();  // they are printed
  CalibrationOptions searching = calibration_options(calibration);
  searching.geometry_only = options.geometry_only;
  CalibratedRobot found = calibrate_robot(std::move(prepared), searching);
  found.setup.diagnostics.warnings.clear();  // calibrate repeats them: what a URDF cannot hold
  print(found.setup.diagnostics);
  say("{}", search_summary(found));
  Findings& findings = found;
  if (found_nothing(found)) {
    say("{} was not written: no pose is unknown, and these samples support no parameter\n",
        options.output);
    return kNotUsable;
  }
  if (!findings.read_back.lost.empty()) say("{}", read_back_text(findings.read_back));
  for (const std::string& reason : findings.judgement.reasons) say("  - {}\n", reason);
  InputOptions next = calibration;
  next.config = options.output;
  findings.call = {options.command, input_options(next), "", KINECAL_VERSION,
                   read_files(calibration, texts)};
  write_reports(calibration, texts, found);
  if (findings.judgement.verdict == Grade::do_not_use) {
    say("{} · {} was not written\n", findings_line(findings), options.output);
    return kNotUsable;
  }
  write_output(options.output, found_config(found));
  std::string line = findings_line(findings) + " · " + options.output;
  for (const std::string& report : options.reports) line += " · " + report;
  say("{}\n", line);
  if (!are_files(inputs, options.output)) return kDone;
  say("{}", deciding_command(found, next));
  say("next: {}\n", calibrate_command(next).str());
  return kDone;
}

}  // namespace kinecal::cli
