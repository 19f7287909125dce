// Text of the starts of a step.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <sstream>

#include "kinecal/solve/start_summary.hpp"

namespace kinecal {

namespace detail {

KINECAL_INLINE void add_minimum(StartSummary& summary, double cost, double rounding) {
  auto& minima = summary.minima;
  const auto same = std::find_if(minima.begin(), minima.end(), [&](const FoundMinimum& known) {
    return std::abs(known.cost - cost) <= kSameCost * std::max(known.cost, cost) + rounding;
  });
  if (same != minima.end()) {
    ++same->solves;
    same->cost = std::min(same->cost, cost);
    return;
  }
  const auto above = std::find_if(minima.begin(), minima.end(),
                                  [&](const FoundMinimum& known) { return known.cost > cost; });
  minima.insert(above, {cost, 1});
}

[[nodiscard]] inline std::string quoted(const std::vector<std::string>& names) {
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    all += (i == 0 ? "'" : i + 1 == names.size() ? " and '" : ", '") + names[i] + "'";
  }
  return all;
}

[[nodiscard]] inline std::string count_of(int count, const char* one, const char* several) {
  return std::to_string(count) + " " + (count == 1 ? one : several);
}

inline void list_minima(std::ostream& out, const StartSummary& summary) {
  constexpr std::size_t kListed = 5;
  const auto& minima = summary.minima;
  if (minima.empty()) {
    out << "0 minima";
    return;
  }
  out << count_of(static_cast<int>(minima.size()), "minimum, cost", "minima, costs");
  for (std::size_t i = 0; i < std::min(kListed, minima.size()); ++i) {
    out << (i == 0 ? " " : ", ") << minima[i].cost;
    if (minima.size() > 1 && static_cast<int>(i) == summary.taken) out << " (taken)";
  }
  if (minima.size() > kListed) out << ", ...";
}

}  // namespace detail

KINECAL_INLINE std::string to_string(const StartSummary& summary) {
  if (!summary.searched()) return {};
  std::ostringstream out;
  out.precision(6);
  if (summary.starts > 0) {
    const auto poses = [&](const std::vector<std::string>& frames, const char* what) {
      const bool one = frames.size() == 1;
      out << (one ? "pose of " : "poses of ") << detail::quoted(frames)
          << (one ? " was " : " were ") << what;
    };
    if (!summary.frames.empty()) poses(summary.frames, "not known");
    if (!summary.frames.empty() && !summary.given.empty()) out << ", ";
    if (!summary.given.empty()) poses(summary.given, "given, but the fit from there ended badly");
    out << ": " << (summary.minima.empty() ? "not found from " : "found from ") << summary.starts
        << " starts";
  }
  if (summary.random_starts > 0) {
    out << (summary.starts > 0 ? ", and " : "")
        << detail::count_of(summary.random_starts, "random start", "random starts")
        << " (joints within " << random_start::kJointDegrees << " degrees or "
        << 100.0 * random_start::kJointMetres << " cm, frames within "
        << random_start::kFrameDegrees << " degrees and " << 100.0 * random_start::kFrameMetres
        << " cm)";
  }
  out << "; ";
  detail::list_minima(out, summary);
  if (summary.failed > 0) {
    out << "; " << detail::count_of(summary.failed, "solve", "solves") << " ended in none";
  }
  return out.str();
}

}  // namespace kinecal
