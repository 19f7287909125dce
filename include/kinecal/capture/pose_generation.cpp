// Definitions of pose_generation.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/pose_generation.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/view_search.ipp"

namespace kinecal {

namespace detail {

using Places = std::vector<std::vector<double>>;

[[nodiscard]] inline double squared_distance(const std::vector<double>& a,
                                             const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/// Indices of places far from each other: each next one is the farthest from all before.
[[nodiscard]] inline std::vector<std::size_t> spread(const Places& places, std::size_t count) {
  std::vector<double> nearest(places.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> chosen;
  for (std::size_t next = 0; chosen.size() < std::min(count, places.size());) {
    chosen.push_back(next);
    for (std::size_t i = 0; i < places.size(); ++i) {
      nearest[i] = std::min(nearest[i], squared_distance(places[i], places[next]));
    }
    next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) -
                                    nearest.begin());
  }
  return chosen;
}

/// The same indices, reordered so that each is the nearest to the one before.
[[nodiscard]] inline std::vector<std::size_t> short_ways(const Places& places,
                                                         std::vector<std::size_t> indices) {
  for (std::size_t i = 1; i < indices.size(); ++i) {
    const auto from = static_cast<std::ptrdiff_t>(i);
    const std::vector<double>& here = places[indices[i - 1]];
    const auto nearer = [&](std::size_t a, std::size_t b) {
      return squared_distance(places[a], here) < squared_distance(places[b], here);
    };
    std::iter_swap(indices.begin() + from,
                   std::min_element(indices.begin() + from, indices.end(), nearer));
  }
  return indices;
}

/// Searches from one start: keeps changes of a joint that do not make the view worse.  Once the
/// target is visible, it continues among good poses, or all would lie at the edge of the good
/// region.
/// @param q  in: where to start; out: the last pose that can be used, if there is one
/// @returns  what is wrong with the best pose; empty if one is usable
[[nodiscard]] inline ViewFault search(const ViewSearch& view, std::vector<double>& q,
                                      std::mt19937_64& random) {
  constexpr int kSteps = 400, kWander = 60;
  std::vector<double> here = q;
  ViewFault least = view.fault(here);
  bool is_usable = false;
  for (int n = 0, seen = 0; n < kSteps && seen < kWander; ++n) {
    std::vector<double> other = here;
    view.change(other, random);
    ViewFault fault = view.fault(other);
    if (fault.size > least.size) continue;
    here = std::move(other);
    least = std::move(fault);
    if (least.size > 0.0) continue;
    ++seen;
    least.what = view.obstacle(here);
    if (!least.what.empty()) continue;
    is_usable = true;
    q = here;
  }
  if (is_usable) least.what.clear();
  return least;
}

}  // namespace detail

std::vector<JointTarget> poses_with_view_of(const Robot& robot, const ViewGoal& goal, int count,
                                            std::uint64_t seed) {
  constexpr int kCandidates = 4, kTries = 40, kMore = 1000;  // per pose; in all
  const detail::ViewSearch view(robot, goal);
  std::mt19937_64 random(seed);
  detail::Places found, shares;
  detail::ViewFault best;
  best.size = std::numeric_limits<double>::infinity();
  for (int n = 0; n < kTries * count + kMore; ++n) {
    if (static_cast<int>(found.size()) >= kCandidates * count) break;
    std::vector<double> q = view.anywhere(random);
    const detail::ViewFault fault = detail::search(view, q, random);
    if (fault.size < best.size) best = fault;
    if (!fault.what.empty()) continue;
    shares.push_back(view.shares(q));
    found.push_back(std::move(q));
  }
  if (found.empty() && count > 0) {
    throw std::runtime_error("no pose in which '" + goal.camera + "' sees the target on '" +
                             goal.target + "'; in the best one " + best.what);
  }
  std::vector<JointTarget> targets;
  const auto chosen = detail::spread(shares, static_cast<std::size_t>(std::max(count, 0)));
  for (const std::size_t i : detail::short_ways(shares, chosen)) {
    targets.push_back(view.target(found[i]));
  }
  return targets;
}

}  // namespace kinecal
