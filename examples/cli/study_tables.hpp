// The tables of a study, as text and for programs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/study/study_summary.hpp"
#include "remaining_error.hpp"
#include "study_input.hpp"

namespace kinecal::cli {

/// The results of a study.
struct StudyResult {
  std::vector<StudyGroup> groups;                ///< by robot, then by number of poses
  std::vector<double> before;                    ///< error of each robot with its URDF, metres
  std::size_t jobs = 0;                          ///< planned jobs
  std::size_t done = 0;                          ///< that are done
  double limit = 0.0;                            ///< of the mean re-projection error
  double solves_per_second = 0.0;                ///< and core
  std::optional<RemainingError> remaining = {};  ///< if more than the limit remains without noise
};

/// What a study found, in words.
struct StudyText {
  std::string about;                ///< robot, number of poses and parameters
  std::vector<std::string> tables;  ///< I, II and III of the Fetch paper, each with its title
  std::string sums;                 ///< over all robots
  std::string linearity;            ///< whether the covariance describes the trials; may be empty
  bool linear = true;               ///< so it does, as far as is known
};

[[nodiscard]] StudyText study_texts(const StudyInput& input, const StudyResult& result);

/// The same in one text.
[[nodiscard]] std::string study_text(const StudyInput& input, const StudyResult& result);

/// The same as JSON.
[[nodiscard]] std::string study_json(const StudyInput& input, const StudyResult& result);

/// Largest mean re-projection error that remains without noise, of all groups.
[[nodiscard]] double systematic_error(const StudyResult& result);

/// Unit of the residual of the first error block that has samples: "m" or "px".
[[nodiscard]] std::string unit_of_study(const StudyInput& input);

/// Median of the ratio of variances with the fewest and with the most poses, over the determined
/// parameters of a robot; zero without two numbers of poses.
[[nodiscard]] double variance_ratio(const StudyResult& result, int robot);

}  // namespace kinecal::cli
