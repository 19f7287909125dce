// Choosing what to do next.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/next_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "kinecal/report/findings.hpp"
#include "kinecal/report/parameters_text.ipp"

namespace kinecal {

namespace detail {
namespace {

/// Names for --hold: that of a frame in place of its six parameters.
[[nodiscard]] std::vector<std::string> names_to_hold(const std::vector<int>& parameters,
                                                     const ParameterTable& table) {
  std::set<std::string> names;
  for (const int p : parameters) names.insert(table[p].name);
  std::vector<std::string> held;
  for (const int p : parameters) {
    const std::string& name = table[p].name;
    const std::string frame = name.substr(0, name.rfind('_'));
    const bool whole = std::all_of(kFrameAxes.begin(), kFrameAxes.end(), [&](const auto axis) {
      return names.contains(parameter_name(frame, axis));
    });
    if (!whole) {
      held.push_back(name);
    } else if (name == parameter_name(frame, kFrameAxes.front())) {
      held.push_back(frame);
    }
  }
  return held;
}

/// The call with other options.
[[nodiscard]] std::string again(const Findings& findings, const ShellCommand& options) {
  const ProgramCall& call = findings.call;
  const bool wrote = !call.output.empty() && findings.judgement.verdict != Grade::do_not_use;
  ShellCommand command = call.command;
  command.add(options);
  if (wrote && !call.command.has("--force")) command.add({"--force"});
  return command.str();
}

/// ":" and a command of its own line; empty if the program was not called.
/// @param inputs  as of ProgramCall
[[nodiscard]] std::string with_inputs(const char* name, const ShellCommand& inputs) {
  if (inputs.empty()) return "";
  return ":\n  " + ShellCommand{"kinecal", name}.add(inputs).str();
}

/// Parameters that may be held where they were: not those of a pose that nobody knew.
[[nodiscard]] std::vector<int> with_a_value(const Findings& findings, std::vector<int> parameters) {
  std::erase_if(parameters, [&](int p) { return was_unknown(findings, findings.result.table[p]); });
  return parameters;
}

/// Parameters that might as well be held, or that samples do not determine; empty if absent.
[[nodiscard]] std::string hold(const Findings& findings) {
  if (findings.assessments.empty()) return {};
  const Assessment& step = findings.assessments.back();
  const bool refused = findings.judgement.verdict == Grade::do_not_use;
  std::vector<int> parameters = with_a_value(findings, step.weak.hold);
  std::string why = "what these samples hardly determine";
  if (refused || parameters.empty()) {
    std::vector<int> open = step.observability.hold;
    const std::vector<int> known = with_a_value(findings, open);
    if (known.size() + 1 < open.size()) open = known;  // one direction may be chosen freely
    if (!open.empty()) {
      parameters = open;
      why = "what these samples do not determine";
    }
  }
  if (parameters.empty() && !refused) {
    for (const IdleGroup& group : step.idle) {
      parameters.insert(parameters.end(), group.parameters.begin(), group.parameters.end());
    }
    why = "what does not help the fit";
  }
  if (parameters.empty()) return {};
  const std::vector<std::string> names = names_to_hold(parameters, findings.result.table);
  return "hold " + why + ":\n  " +
         (findings.call.command.empty()
              ? fmt::format("{}", fmt::join(names, " "))
              : again(findings, ShellCommand().add_names("--hold", names)));
}

/// What serves the reader of a URDF that cannot hold the result: tried, if it is to hold what is lost.
[[nodiscard]] std::string serve_reader(const Findings& findings) {
  const ReadBack& read_back = findings.read_back;
  const ShellCommand& command = findings.call.command;
  const auto with = [&](const std::string& option, const std::string& value) {
    const bool can_add = !command.empty() && !command.has(option);
    return can_add ? ":\n  " + again(findings, {option, value}) : "";
  };
  if (read_back.judged == Reader::origins || read_back.lost.empty()) {
    return "write zeros into origins, which all programs read" + with("--offsets", "origin");
  }
  constexpr double kBetter = 1.1;
  const std::vector<BlockError>& now = read_back.of(read_back.judged)->errors;
  if (times_larger(now, read_back.geometry_only) > kBetter) {
    const ShellCommand& inputs = findings.call.inputs;
    return "find what a URDF holds: it alone then leaves " + errors_text(read_back.geometry_only) +
           (inputs.empty() ? ""
                           : ":\n  " + ShellCommand{"kinecal", "identify"}
                                           .add(inputs)
                                           .add({"--geometry-only", "-o", "geometry.yaml"})
                                           .str());
  }
  return "apply calibration.yaml in the driver (true_position.hpp), and judge the result for it" +
         with("--reader", "driver");
}

}  // namespace
}  // namespace detail

std::string next_step(const Findings& findings) {
  const Judgement& judgement = findings.judgement;
  const ProgramCall& call = findings.call;
  constexpr double kMuch = 0.5;  // of the error on held-out poses
  const Remedy remedy = judgement.remedies.empty() ? Remedy{} : judgement.remedies.front();
  using Kind = Remedy::Kind;
  if (remedy.kind == Kind::serve) return detail::serve_reader(findings);
  if (judgement.verdict != Grade::good && findings.helps_leave < kMuch) {
    return "find out what else is wrong" + detail::with_inputs("identify", call.inputs);
  }
  if (judgement.verdict == Grade::good) {
    if (findings.has_sample_poses) {  // nothing says where the target is in new samples
      return "use the files in " + (call.output.empty() ? "the output" : call.output) +
             ", and calibrate other samples, too: the results should agree";
    }
    if (call.output.empty()) return "verify the result with a few new poses";
    return "use " + call.output + "/" + findings.driver_file +
           (findings.driver_file == "calibrated.urdf"
                ? ", and verify it with a few new poses:\n  "
                : ", and verify it with a new recording:\n  ") +
           ShellCommand{"kinecal", "verify", shell_file(call.output), "NEW_SAMPLES"}.str();
  }
  if (remedy.kind == Kind::mend) {
    if (!remedy.how.empty()) return remedy.how + ", and calibrate again";
    return std::string(judgement.causes > 1 ? "mend the causes" : "mend the cause") +
           " named under the verdict, and calibrate again";
  }
  const std::string held = remedy.kind == Kind::hold ? detail::hold(findings) : "";
  if (!held.empty()) return held;
  const bool is_open =
      !findings.assessments.empty() && !findings.assessments.back().weak.hold.empty();
  if (remedy.kind == Kind::record || (remedy.kind == Kind::hold && is_open)) {
    return std::string("record more poses") + (call.inputs.empty() ? "" : "; which") +
           detail::with_inputs("plan", call.inputs);
  }
  return "see where residuals are large" +
         (call.command.empty() ? ""
                               : ":\n  " + detail::again(findings, {"--report", "report.html"}));
}

}  // namespace kinecal
