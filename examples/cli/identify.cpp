// kinecal identify: finds out what is wrong with a robot.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/config/assemble.hpp"
#include "kinecal/config/config_to_yaml.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/results/standard_output.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/report/findings.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/text/shell_word.hpp"
#include "kinecal/tools/identify/identified_config.hpp"
#include "kinecal/tools/init/answers_from_samples.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "output_file.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// The configuration that samples suggest: their sensors, and the poses that the URDF does not have.
void propose_configuration(IdentifyOptions& options) {
  Diagnostics diagnostics;
  const Recording recording = read_recordings(options.samples, diagnostics);
  diagnostics.throw_if_errors();  // warnings come when they are read again
  if (options.urdf.empty() && recording.urdf.empty()) {
    throw InputError("--urdf: is required, because the samples contain no /robot_description");
  }
  const Robot robot = options.urdf.empty() ? parse_urdf(recording.urdf, "/robot_description")
                                           : read_urdf(options.urdf);
  try {
    options.config_text = initial_config(robot, answers_from_samples(robot, recording.samples, {}));
  } catch (const InputError& error) {
    throw InputError(
        "the samples do not tell what observes what; give --config, as of 'kinecal init'.  " +
        std::string(error.what()));
  }
}

/// What was searched and found.
struct Search {
  IdentifyTask task;
  Identified found;
  Config config;  ///< that frees what was found
};

Search search(const Config& config, const Robot& robot, std::span<const Sample> samples,
              bool geometry_only) {
  Search all;
  Diagnostics diagnostics;
  Calibration calibration =
      assemble(with_all_candidates(config, robot, samples), robot, samples, diagnostics);
  diagnostics.throw_if_errors();
  const AnyProblem& problem = *calibration.steps.front().problem;
  all.task = identify_task(config, problem, samples, geometry_only);
  all.found = identify(calibration, samples, all.task.base, all.task.candidates);
  all.config = identified_config(config, all.task, all.found, problem);
  return all;
}

/// Judges what was found as 'kinecal calibrate' will.
JudgedResult judged(const Search& search, const Input& input) {
  if (free_parameters(search.config.steps.front()).empty()) return {};
  Diagnostics diagnostics;
  Calibration calibration = assemble(search.config, input.robot, input.samples, diagnostics);
  diagnostics.throw_if_errors();
  ProcedureOptions options;
  options.doubts = input.diagnostics.doubts;
  return calibrate_and_judge(calibration, input.samples, options);
}

/// The name of a step: what it freed.
std::string name_of(const Search& search, const IdentifyStep& step) {
  if (step.candidate < 0) return "(only unknown poses)";
  return search.task.candidates[static_cast<std::size_t>(step.candidate)].name;
}

std::string steps_text(const Search& search) {
  const Identified& found = search.found;
  const std::string unit = reading_unit(found.unit);
  TextTable table({"freed", "fitted", "held out", "regions held out", "unit", "times its +-"});
  for (const IdentifyStep& step : found.steps) {
    const auto text = [&](double value) { return in_reading_unit(value, found.unit); };
    table.add({name_of(search, step), text(step.fitted), text(step.held_out),
               step.region > 0.0 ? text(step.region) : "-", unit,
               step.candidate < 0 ? "" : fmt::format("{:.1f}", std::abs(step.certainty))});
  }
  std::string text;
  for (const auto& [k, turn] : found.turned) {
    text += fmt::format("the zero of '{}' is {:+.0f} deg off: the search begins there\n\n",
                        search.task.candidates[static_cast<std::size_t>(k)].name,
                        turn * 180.0 / std::numbers::pi);
  }
  text += table.str();
  for (const IdentifyStep& step : found.steps) {
    if (step.alike.empty()) continue;
    std::string others;
    constexpr std::size_t kShown = 4;
    for (std::size_t i = 0; i < std::min(kShown, step.alike.size()); ++i) {
      const auto k = static_cast<std::size_t>(step.alike[i]);
      others += (i == 0 ? "" : ", ") + search.task.candidates[k].name;
    }
    if (step.alike.size() > kShown)
      others += fmt::format(" and {} more", step.alike.size() - kShown);
    text +=
        fmt::format("in place of {}, these explain the same: {}\n", name_of(search, step), others);
  }
  return text;
}

/// Comments of the configuration: what each parameter bought.
std::map<std::string, std::string> comments(const Search& search) {
  std::map<std::string, std::string> why;
  const Identified& found = search.found;
  for (std::size_t i = 1; i < found.steps.size(); ++i) {
    const auto k = static_cast<std::size_t>(found.steps[i].candidate);
    for (const int p : search.task.candidates[k].parameters) {
      why.emplace(found.result.table[p].name,
                  fmt::format("held out {} -> {}", reading(found.steps[i - 1].held_out, found.unit),
                              reading(found.steps[i].held_out, found.unit)));
    }
  }
  return why;
}

}  // namespace

int identify(IdentifyOptions options) {
  std::vector<std::string> inputs = options.samples;
  inputs.insert(inputs.end(), {options.urdf, options.config});
  check_output(options.output, inputs, options.force);
  const bool is_proposed = options.config.empty();
  if (is_proposed) propose_configuration(options);
  Input input = read_input(options);
  print_or_throw(input.diagnostics);
  if (input.config.steps.size() != 1) {
    throw InputError(options.config + ": has " + counted(input.config.steps.size(), "step") +
                     "; identify searches in one");
  }
  if (is_proposed) {  // its sigmas are guesses
    for (BlockConfig& block : input.config.steps.front().error_blocks) block.sigma.reset();
  }
  Search all = search(input.config, input.robot, input.samples, options.geometry_only);
  Findings findings{judged(all, input)};
  if (!findings.left_out.empty()) {  // again, without bad samples
    all = search(input.config, input.robot, used_samples(findings, input.samples),
                 options.geometry_only);
    findings = Findings{judged(all, input)};
  }
  say("Robot '{}', {}: {} may be wrong, {} of them these samples support\n\n{}", input.robot.name(),
      counted(input.samples.size(), "sample"), counted(all.task.candidates.size(), "parameter"),
      all.found.chosen.size(), steps_text(all));
  for (const std::string& reason : findings.judgement.reasons) say("  - {}\n", reason);
  if (findings.judgement.verdict == Grade::do_not_use) {
    say("{} · {} was not written\n", findings_line(findings), options.output);
    return kNotUsable;
  }
  write_text_file(
      options.output,
      config_to_yaml(
          all.config,
          "What these samples support; 'kinecal identify' found it.  With each parameter, the\n"
          "error on poses held out before and after it was freed.",
          comments(all)));
  say("{} · {}\n", findings_line(findings), options.output);
  if (std::any_of(inputs.begin(), inputs.end(), detail::is_stream) ||
      is_standard_output(options.output))
    return kDone;
  options.config = options.output;
  say("next: kinecal calibrate {} --output calibrated\n", input_options(options));
  return kDone;
}

}  // namespace kinecal::cli
