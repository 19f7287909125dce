// Definitions of tell_apart.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/identify/tell_apart.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/identify/candidates.ipp"
#include "kinecal/tools/identify/identified_config.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The candidate of a name, or the one that has the parameter.
[[nodiscard]] int explanation_of(const IdentifyTask& task, const ParameterTable& table,
                                 const std::string& name) {
  std::set<std::string> known;
  int with_parameter = -1;
  for (int k = 0; k < static_cast<int>(task.candidates.size()); ++k) {
    const IdentifyCandidate& of = task.candidates[static_cast<std::size_t>(k)];
    if (of.name == name) return k;
    known.insert(of.name);
    for (const int p : of.parameters) {
      if (table[p].name == name) with_parameter = k;
    }
  }
  if (with_parameter >= 0) return with_parameter;
  for (const int p : task.base) {
    if (table[p].name == name) {
      throw InputError("--tell-apart: '" + name + "' is of a pose that is always free");
    }
  }
  throw InputError("--tell-apart: '" + name + "' is not a candidate of 'kinecal identify'" +
                   did_you_mean(name, known));
}

/// The parameters of a mount that is always free, by the name of its frame or one of them; empty: it is another.
[[nodiscard]] std::vector<int> mount_in_base(const IdentifyTask& task, const AnyProblem& problem,
                                             const std::string& name) {
  const auto owner = [&](int p) { return problem.owners()[static_cast<std::size_t>(p)]; };
  const auto named = std::find_if(task.base.begin(), task.base.end(), [&](int p) {
    return problem.robot().has_joint(owner(p)) &&
           (problem.table()[p].name == name || name == "frame of " + owner(p));
  });
  std::vector<int> own;
  if (named == task.base.end()) return own;
  std::copy_if(task.base.begin(), task.base.end(), std::back_inserter(own),
               [&](int p) { return owner(p) == owner(*named); });
  return own;
}

}  // namespace
}  // namespace detail

Explanations free_explanations(const Config& config, const Robot& robot,
                               std::span<const Sample> samples,
                               const std::vector<std::string>& names) {
  if (names.size() != 2) {
    throw InputError("--tell-apart: takes two names, such as elbow_joint,elbow_joint_gear_ratio");
  }
  if (config.steps.size() != 1) {
    throw InputError("--tell-apart: takes a configuration of one step");
  }
  Diagnostics diagnostics;
  const Calibration calibration =
      assemble(with_all_candidates(config, robot, samples), robot, samples, diagnostics);
  diagnostics.throw_if_errors();
  const AnyProblem& problem = *calibration.steps.front().problem;
  const IdentifyTask task = identify_task(config, problem, samples);
  Explanations both;
  std::set<int> chosen;
  for (int k = 0; k < static_cast<int>(task.candidates.size()); ++k) {  // free already
    const std::vector<int>& own = task.candidates[static_cast<std::size_t>(k)].parameters;
    if (std::all_of(own.begin(), own.end(), [&](int p) {
          return detail::is_free(config.steps.front(), problem.table()[p].name);
        }))
      chosen.insert(k);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    std::vector<int> own = detail::mount_in_base(task, problem, names[i]);
    if (own.empty()) {
      const int k = detail::explanation_of(task, problem.table(), names[i]);
      chosen.insert(k);
      own = task.candidates[static_cast<std::size_t>(k)].parameters;
    }
    for (const int p : own) both.parameters[i].push_back(problem.table()[p].name);
  }
  for (const std::string& name : both.parameters[0]) {
    const auto& other = both.parameters[1];
    if (std::find(other.begin(), other.end(), name) == other.end()) continue;
    throw InputError("--tell-apart: '" + names[0] + "' and '" + names[1] + "' are the same");
  }
  Identified as_found;
  as_found.chosen.assign(chosen.begin(), chosen.end());
  both.config = identified_config(config, task, as_found, problem);
  StepConfig& step = both.config.steps.front();
  for (const FreeParamConfig& given :
       config.steps.front().free_params) {  // beside whole candidates
    if (!detail::is_free(step, given.name)) step.free_params.push_back(given);
  }
  return both;
}

bool sees_everywhere(const Config& config) {
  return std::all_of(config.steps.front().models.begin(), config.steps.front().models.end(),
                     [](const ModelConfig& model) {
                       const SensorEntry* entry = entry_of(model);
                       return entry != nullptr && entry->sensor->parameters().empty();
                     });
}

}  // namespace kinecal
