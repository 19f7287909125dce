// Definitions of spread.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/spread.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kinecal {

std::vector<std::size_t> thinned(std::size_t size, std::size_t count) {
  std::vector<std::size_t> chosen;
  const std::size_t n = std::min(size, count);
  chosen.reserve(n);
  const double piece = n > 0 ? static_cast<double>(size) / static_cast<double>(n) : 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double turns = static_cast<double>(i) * std::numbers::phi;
    const double place = n < size ? turns - std::floor(turns) : 0.5;
    const auto index = static_cast<std::size_t>((static_cast<double>(i) + place) * piece);
    chosen.push_back(std::min(index, size - 1));
  }
  return chosen;
}

std::vector<std::size_t> spread(std::span<const Vector3<double>> points, std::size_t count) {
  // The farthest of all is among the farthest of many; beyond a few thousand, pieces are even
  // enough.
  constexpr std::size_t kLeastPool = 2048, kMostCount = 2048;
  if (count >= points.size() || count > kMostCount) return thinned(points.size(), count);
  std::vector<std::size_t> chosen;
  if (count == 0) return chosen;
  const std::vector<std::size_t> pool = thinned(points.size(), std::max(kLeastPool, 4 * count));
  std::vector<double> distance(pool.size(), std::numeric_limits<double>::infinity());
  std::size_t farthest = pool.size() / 2;
  while (true) {
    chosen.push_back(pool[farthest]);
    if (chosen.size() == count) break;
    const Vector3<double>& last = points[chosen.back()];
    for (std::size_t i = 0; i < pool.size(); ++i) {
      distance[i] = std::min(distance[i], (points[pool[i]] - last).squaredNorm());
    }
    const auto most = std::max_element(distance.begin(), distance.end());
    if (!(*most > 0.0)) break;  // the remaining points coincide with chosen ones
    farthest = static_cast<std::size_t>(most - distance.begin());
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace kinecal
