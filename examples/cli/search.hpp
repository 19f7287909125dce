// A search for what is free, and the calibration with it: of identify, and of calibrate where a configuration leaves it open.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "commands.hpp"
#include "fit.hpp"
#include "input.hpp"
#include "kinecal/tools/identify/robot_search.hpp"

namespace kinecal::cli {

/// What was searched, and the calibration with what was found.
struct SearchedFit {
  RobotSearch search;
  Fit fit;             ///< without result if nothing is free
  std::string config;  ///< that frees it, as YAML with comments

  [[nodiscard]] bool is_empty() const;  ///< nothing is free
};

/// Searches, and calibrates with what was found; again without samples that do not fit.  The input then has the
/// configuration that frees what was found, and the warnings and doubts about it.
/// @param input  whose is_searched is true
/// @throws InputError  as search_robot() and fit()
[[nodiscard]] SearchedFit search_and_fit(Input& input, const CalibrateOptions& options,
                                         bool geometry_only, const Progress& progress,
                                         const SolveOptions& solving);

/// "Robot 'ur5e', 60 samples: 54 parameters may be wrong, 3 of them these samples support", and the table of steps.
[[nodiscard]] std::string search_summary(const SearchedFit& searched, const Input& input);

}  // namespace kinecal::cli
