// A wrong scale of points that lengths have absorbed: for robot_search.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/doubts/likely_causes.hpp"
#include "kinecal/text/first_names.hpp"
#include "kinecal/tools/identify/candidates.ipp"
#include "kinecal/tools/identify/robot_search.hpp"

namespace kinecal::detail {

/// Sentences about a scale of points that the lengths which were freed may have absorbed.
[[nodiscard]] inline std::vector<std::string> scales_in_lengths(const Config& config,
                                                                const Robot& robot,
                                                                std::span<const Sample> samples,
                                                                const AnyProblem& problem,
                                                                const RobotSearch& search) {
  Identified others;  // what was found without lengths, and all zeros
  others.result = search.found.result;
  others.turned = search.found.turned;
  std::vector<std::string> lengths;
  for (int k = 0; k < static_cast<int>(search.task.candidates.size()); ++k) {
    const auto& chosen = search.found.chosen;
    const bool is_chosen = std::find(chosen.begin(), chosen.end(), k) != chosen.end();
    const int rank = search.task.candidates[static_cast<std::size_t>(k)].rank;
    if (rank == kZero || (is_chosen && rank < kGeometry)) {
      others.chosen.push_back(k);
    } else if (is_chosen) {
      lengths.push_back(search.task.candidates[static_cast<std::size_t>(k)].name);
    }
  }
  constexpr std::size_t kFewest = 2;  // one length is as simple as one scale
  if (lengths.size() < kFewest) return {};
  std::vector<std::string> scales = scales_without_lengths(
      identified_config(config, search.task, others, problem), robot, samples);
  for (std::string& scale : scales) {
    scale += fmt::format(
        " with {} held, which may have absorbed it: are the lengths of these "
        "points right?",
        first_names(lengths));
  }
  return scales;
}

}  // namespace kinecal::detail
