// What was done to find where a step starts, and what it found.
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

/// A minimum of the cost at which some solves ended.
struct FoundMinimum {
  double cost = 0.0;  ///< the lowest of these solves
  int solves = 0;     ///< how many ended there
};

/// The starts of a step.  Empty if it had only the one that the configuration gives.
struct StartSummary {
  std::vector<std::string> frames = {};   ///< whose pose was searched for
  int starts = 0;                         ///< of that search, with frames alone
  int random_starts = 0;                  ///< with joints and frames moved at random
  int failed = 0;                         ///< solves with everything free that ended in no minimum
  std::vector<FoundMinimum> minima = {};  ///< of solves with everything free; lowest first
  int taken = -1;                         ///< which of the minima is the result; -1: none
  double seconds = 0.0;                   ///< wall time of all starts

  /// True if there was more than one start.
  [[nodiscard]] bool searched() const { return starts > 0 || random_starts > 0; }
};

namespace detail {
/// Adds a solve that ended at a minimum; costs that differ by rounding are one minimum.
/// @param rounding  a difference that means nothing, in units of the cost
void add_minimum(StartSummary& summary, double cost, double rounding = 0.0);
/// Costs that differ by less are equal, relatively: a solve stops at its rounding.
inline constexpr double kSameCost = 1e-6;
}  // namespace detail

/// The summary in words: "pose of 'tracker' was not known: found from 60 starts; 2 minima, costs
/// 0.00012 (taken), 0.35".  Empty if nothing was searched.
[[nodiscard]] std::string to_string(const StartSummary& summary);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/start_summary.ipp"
#endif
