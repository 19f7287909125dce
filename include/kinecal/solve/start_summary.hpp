// Summary of the search for a step's start: what was tried and found.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/linkage.hpp"

namespace kinecal {

/// How far random starts move parameters, to either side.
namespace random_start {
inline constexpr double kJointDegrees = 10.0;  ///< offset of a joint that turns
inline constexpr double kJointMetres = 0.02;   ///< offset of a joint that slides
inline constexpr double kFrameDegrees = 10.0;  ///< each component of a frame's rotation vector
inline constexpr double kFrameMetres = 0.05;   ///< each component of a frame's translation
}  // namespace random_start

/// A minimum of the cost that some solves reached.
struct FoundMinimum {
  double cost = 0.0;  ///< the lowest of these solves
  int solves = 0;     ///< how many reached it
};

/// The starts of a step.  Empty if only the configured start was used.
struct StartSummary {
  std::vector<std::string> frames = {};  ///< frames whose pose was searched for: nobody gave it
  std::vector<std::string> given =
      {};                 ///< the same though it was given: from there the fit ended badly
  int starts = 0;         ///< of that search, fitting frames only
  int random_starts = 0;  ///< with joints and frames moved at random
  int failed = 0;         ///< solves of everything that reached no minimum
  std::vector<FoundMinimum> minima = {};  ///< of solves of everything; lowest first
  int taken = -1;                         ///< index of the resulting minimum; -1: none
  double seconds = 0.0;                   ///< wall time of all starts

  /// True if there was more than one start.
  [[nodiscard]] bool searched() const { return starts > 0 || random_starts > 0; }
};

namespace detail {
/// Adds a solve that reached a minimum; costs that differ only by rounding are the same minimum.
/// @param rounding  a negligible difference, in units of the cost
void add_minimum(StartSummary& summary, double cost, double rounding = 0.0);
/// Costs with a smaller relative difference are equal: solves stop at their rounding.
inline constexpr double kSameCost = 1e-6;
}  // namespace detail

/// The summary as text: "pose of 'tracker' was not known: found from 60 starts; 2 minima, costs
/// 0.00012 (taken), 0.35".  Empty if nothing was searched.
[[nodiscard]] std::string to_string(const StartSummary& summary);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/start_summary.ipp"
#endif
