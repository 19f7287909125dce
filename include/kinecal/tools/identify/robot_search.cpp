// Definitions of robot_search.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/identify/robot_search.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/exchanged_joints.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/hold_parameters.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/first_names.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/text/reading.hpp"
#include "kinecal/tools/identify/candidates.ipp"

namespace kinecal {

namespace detail {
namespace {

[[nodiscard]] const IdentifyCandidate& candidate_of(const RobotSearch& search, int candidate) {
  return search.task.candidates[static_cast<std::size_t>(candidate)];
}

[[nodiscard]] std::string name_of(const RobotSearch& search, int candidate) {
  return candidate_name(candidate_of(search, candidate), search.found.result.table);
}

/// "-0.21 deg"; of a frame how far and by how much it turned, "5.0 mm, 2.0 deg".
[[nodiscard]] std::string change_of(const ParameterTable& table, const std::vector<int>& parameters,
                                    bool is_frame) {
  std::map<std::string, double> squares;
  std::string text;
  const auto add = [&](double change, const std::string& unit) {
    text += (text.empty() ? "" : ", ") + reading(change, unit);
  };
  for (const int p : parameters) {
    const double change = table[p].value - table[p].initial;
    if (!is_frame) add(change, table[p].unit);
    squares[table[p].unit] += change * change;
  }
  if (!is_frame) return text;
  for (const auto& [unit, square] : squares) add(std::sqrt(square), unit);
  return text;
}

[[nodiscard]] ReportedSearchStep reported_step(const RobotSearch& search, const IdentifyStep& step,
                                               bool is_chosen) {
  ReportedSearchStep of{.freed = step.candidate < 0 ? "" : name_of(search, step.candidate),
                        .parameters = step.parameters,
                        .fitted = step.fitted,
                        .held_out = step.held_out,
                        .deviation = step.deviation,
                        .region = step.region,
                        .certainty = step.certainty,
                        .is_chosen = is_chosen};
  for (const int k : step.alike) of.alike.push_back(name_of(search, k));
  for (const int k : step.inseparable) of.inseparable.push_back(name_of(search, k));
  return of;
}

/// What explains the same: first what is inseparable.
[[nodiscard]] std::string same_explanations(const ReportedSearchStep& step) {
  std::string text;
  if (!step.inseparable.empty()) {
    text += fmt::format("either {} or {}: samples like these do not separate them\n", step.freed,
                        first_names(step.inseparable));
  }
  std::vector<std::string> others;
  for (const std::string& name : step.alike) {
    if (std::find(step.inseparable.begin(), step.inseparable.end(), name) ==
        step.inseparable.end()) {
      others.push_back(name);
    }
  }
  if (!others.empty()) {
    text += fmt::format("in place of {}, these explain the same: {}\n", step.freed,
                        first_names(others));
  }
  return text;
}

/// Zeros and mounts that samples do not separate from what is free from the beginning.
[[nodiscard]] std::string absorbed_text(const RobotSearch& search) {
  std::map<std::vector<std::string>, std::vector<std::string>> names;  // by what absorbs them
  for (const AbsorbedParameters& of : search.found.absorbed) {
    if (candidate_of(search, of.candidate).rank > kMount) continue;
    IdentifyCandidate part = candidate_of(search, of.candidate);
    part.parameters = of.parameters;
    names[of.by].push_back(candidate_name(part, search.found.result.table));
  }
  std::string text;
  for (const auto& [by, absorbed] : names) {
    text += fmt::format("inseparable from the pose of {}, which is free and absorbs it: {}\n",
                        fmt::join(by, " or "), fmt::join(absorbed, ", "));
  }
  return text;
}

/// How mounts change that are free from the beginning; not those whose pose the URDF leaves open.
[[nodiscard]] std::string base_mounts_text(const RobotSearch& search, const AnyProblem& problem) {
  std::map<std::string, std::vector<int>> mounts;
  for (const int p : search.task.base) {
    const std::string& owner = problem.owners()[static_cast<std::size_t>(p)];
    if (problem.robot().has_joint(owner)) mounts[owner].push_back(p);
  }
  std::string text;
  for (const auto& [joint, parameters] : mounts) {
    if (!has_origin(problem.robot().joint(joint))) continue;
    text += fmt::format("the frame of {} is free from the beginning and changes by {}\n", joint,
                        change_of(search.found.result.table, parameters, true));
  }
  return text;
}

/// Takes what is held out of a search: a parameter, all of a frame, or a candidate by its name.
/// @param unknown  frames whose pose is searched for
void hold_in_search(const std::vector<std::string>& names, const AnyProblem& problem,
                    const std::vector<UnknownFrame>& unknown, IdentifyTask& task) {
  std::set<std::string> known;
  for (const std::string& name : names) {
    const int parameter = problem.table().find(name);
    const auto is_in_base = [&](const UnknownFrame& frame) {
      return std::find_first_of(task.base.begin(), task.base.end(), frame.axes.begin(),
                                frame.axes.end()) != task.base.end();
    };
    const auto is_held = [&](int p) {  // of a joint: its zero and its frame, as hold_parameters()
      return p == parameter || (problem.frames().contains(name) &&
                                problem.owners()[static_cast<std::size_t>(p)] == name);
    };
    if (std::any_of(unknown.begin(), unknown.end(), [&](const UnknownFrame& frame) {
          if (frame.has_guess || !is_in_base(frame)) return false;
          return frame.name == name ||
                 (parameter >= 0 &&
                  problem.owners()[static_cast<std::size_t>(parameter)] == frame.name);
        })) {
      throw InputError("--hold " + name +
                       ": nothing says where it is, so the search needs it free; a configuration "
                       "can give its pose under 'free_frames_initial_values'");
    }
    std::size_t held = std::erase_if(task.base, is_held);
    for (IdentifyCandidate& candidate : task.candidates) {
      if (candidate.in_part) held += std::erase_if(candidate.parameters, is_held);
    }
    const auto has_held = [&](const IdentifyCandidate& candidate) {
      known.insert(candidate.name);
      return candidate.name == name || candidate.parameters.empty() ||
             std::any_of(candidate.parameters.begin(), candidate.parameters.end(), is_held);
    };
    if (held + std::erase_if(task.candidates, has_held) > 0) continue;
    throw InputError("--hold " + name + ": is not a candidate of the search" +
                     did_you_mean(name, known));
  }
}

/// The turns of zeros with which positions outside the limits are inside.
[[nodiscard]] Turns turns_into_limits(const Config& config, const Robot& robot,
                                      std::span<const Sample> samples, const IdentifyTask& task) {
  Turns all;
  for (const UsedJoint& joint : with_initial_zeros(config, used_joints(config, robot, samples))) {
    if (count_outside(joint, joint) == 0) continue;
    const auto turn = turn_into_limits(joint);
    const auto candidate =
        std::find_if(task.candidates.begin(), task.candidates.end(),
                     [&](const IdentifyCandidate& of) { return of.name == joint.joint.name; });
    if (!turn || candidate == task.candidates.end()) continue;
    all.emplace_back(static_cast<int>(candidate - task.candidates.begin()), *turn);
  }
  return all;
}

}  // namespace
}  // namespace detail

RobotSearch search_robot(const Config& config, const Robot& robot, std::span<const Sample> samples,
                         const SearchLimits& limits) {
  if (config.steps.size() != 1) {
    throw InputError(config.place.file + ": has " + counted(config.steps.size(), "step") +
                     "; a search for what is free is in one");
  }
  RobotSearch all;
  Diagnostics diagnostics;
  Calibration calibration =
      assemble(with_all_candidates(config, robot, samples), robot, samples, diagnostics);
  diagnostics.throw_if_errors();
  const AnyProblem& problem = *calibration.steps.front().problem;
  all.task = identify_task(config, problem, samples, limits.geometry_only);
  detail::hold_in_search(limits.hold, problem, calibration.steps.front().unknown_frames, all.task);
  all.found = identify(calibration, samples, all.task.base, all.task.candidates,
                       detail::turns_into_limits(config, robot, samples, all.task));
  all.config = identified_config(config, all.task, all.found, problem);
  if (all.found.result.converged) all.mounts = detail::base_mounts_text(all, problem);
  Diagnostics of_others;  // what is not free any more
  hold_parameters(all.config, limits.hold, of_others);
  return all;
}

ReportedSearch reported(const RobotSearch& search) {
  ReportedSearch all{search.found.unit};
  for (const IdentifyStep& step : search.found.steps) {
    all.steps.push_back(detail::reported_step(search, step, true));
  }
  for (const IdentifyStep& step : search.found.beyond) {
    all.steps.push_back(detail::reported_step(search, step, false));
  }
  return all;
}

std::string search_text(const RobotSearch& search) {
  const ReportedSearch all = reported(search);
  std::string text;
  for (const auto& [k, turn] : search.found.turned) {
    text += fmt::format("the zero of '{}' is {:+.0f} deg off: the search begins there\n\n",
                        detail::name_of(search, k), turn * 180.0 / std::numbers::pi);
  }
  TextTable table(
      {"freed", "change", "fitted", "held out", "+-", "regions held out", "unit", "times its +-"});
  const auto number = [&](double value) { return in_reading_unit(value, all.unit); };
  for (std::size_t i = 0; i < search.found.steps.size(); ++i) {
    const ReportedSearchStep& step = all.steps[i];
    const int k = search.found.steps[i].candidate;
    std::string change;
    if (k >= 0) {
      const IdentifyCandidate& of = detail::candidate_of(search, k);
      change = detail::change_of(search.found.result.table, of.parameters, of.in_part);
    }
    table.add({k < 0 ? "(only unknown poses)" : step.freed, change, number(step.fitted),
               number(step.held_out), number(step.deviation),
               step.region > 0.0 ? number(step.region) : "-", reading_unit(all.unit),
               k < 0 ? "" : fmt::format("{:.1f}", std::abs(step.certainty))});
  }
  text += table.str();
  for (const ReportedSearchStep& step : all.steps) {
    if (!step.alike.empty()) text += detail::same_explanations(step);
  }
  text += search.mounts + detail::absorbed_text(search);
  return text;
}

std::map<std::string, std::string> search_comments(const RobotSearch& search) {
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

}  // namespace kinecal
