// The free parameters of a step that some residual depends on; the others are reported, by their cause.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/missing_sensors.ipp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Warns of sensors that are in no sample, with what follows from that.
/// @param held  free parameters that keep their initial values
inline void report_missing(const MissingSensors& missing, const StepConfig& step,
                           const std::vector<std::string>& held, Diagnostics& diagnostics) {
  if (missing.models.empty()) return;
  std::vector<std::string> blocks;
  for (const BlockConfig& block : step.error_blocks) {
    if (missing.are_in(block)) blocks.push_back(block.name);
  }
  std::string text = fmt::format("{}; so {} {} no samples", sentence_of(missing),
                                 quoted_list(blocks), blocks.size() == 1 ? "has" : "have");
  if (!held.empty()) {
    text += fmt::format(", and {} {}", quoted_list(held, 3, "parameter"),
                        held.size() == 1 ? "keeps its initial value" : "keep their initial values");
  }
  diagnostics.warning(missing.models.front()->place, text);
}

/// Warns of parameters of one line of the file that have no residual.
inline void report_untouched(const std::vector<const Parameter*>& parameters,
                             const SourceLocation& place, Diagnostics& diagnostics) {
  if (parameters.size() == 1) {
    diagnostics.warning(place, fmt::format("no residual of these samples depends on '{}'; it "
                                           "keeps its initial value {}",
                                           parameters[0]->name, parameters[0]->value));
    return;
  }
  std::vector<std::string> names;
  for (const Parameter* parameter : parameters) names.push_back(parameter->name);
  diagnostics.warning(place, fmt::format("no residual of these samples depends on {}; they keep "
                                         "their initial values",
                                         quoted_list(names)));
}

/// The free parameters of a step that affect residuals, in file order; warns of others.
[[nodiscard]] inline FreeSet free_set(const StepConfig& step, const AnyProblem& problem,
                                      std::span<const Sample> samples,
                                      const MissingSensors& missing, Diagnostics& diagnostics) {
  const ParameterTable& table = problem.table();
  const std::vector<int> touched = problem.touched_parameters();
  const Consequences consequences(missing, step, problem);
  std::vector<int> free;
  std::vector<std::string> held;
  std::vector<std::pair<SourceLocation, std::vector<const Parameter*>>> others;  // by line
  for (const FreeParamConfig& param : free_parameters(step)) {
    const int index = table.find(param.name);
    if (index < 0) continue;
    if (samples.empty() || std::binary_search(touched.begin(), touched.end(), index)) {
      free.push_back(index);
    } else if (consequences.contain(param.name)) {
      held.push_back(param.name);
    } else {
      if (others.empty() || others.back().first.line != param.place.line) {
        others.emplace_back(param.place, std::vector<const Parameter*>());
      }
      others.back().second.push_back(&table[index]);
    }
  }
  report_missing(missing, step, held, diagnostics);
  for (const auto& [place, parameters] : others) report_untouched(parameters, place, diagnostics);
  if (free.empty()) {
    diagnostics.error(step.place, fmt::format("step '{}': these samples determine none of "
                                              "its free parameters",
                                              step.name));
  }
  return FreeSet(std::move(free), table.size());
}

}  // namespace kinecal::detail
