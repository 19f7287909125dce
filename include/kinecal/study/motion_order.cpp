// Definitions of motion_order.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/motion_order.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kinecal {

namespace detail {
namespace {

/// Seconds of a move.
[[nodiscard]] double move_time(const std::vector<double>& a, const std::vector<double>& b,
                               const std::vector<double>& speeds) {
  double most = 0.0;
  for (std::size_t j = 0; j < speeds.size(); ++j) {
    most = std::max(most, std::abs(b[j] - a[j]) / speeds[j]);
  }
  return most;
}

}  // namespace
}  // namespace detail

double motion_time(const JointPlaces& places, const std::vector<int>& order,
                   const std::vector<double>& speeds) {
  double sum = 0.0;
  for (std::size_t i = 1; i < order.size(); ++i) {
    sum += detail::move_time(places[static_cast<std::size_t>(order[i - 1])],
                             places[static_cast<std::size_t>(order[i])], speeds);
  }
  return sum;
}

std::vector<int> motion_order(const JointPlaces& places, const std::vector<int>& poses,
                              const std::vector<double>& speeds) {
  for (const int pose : poses) {
    if (places[static_cast<std::size_t>(pose)].size() != speeds.size()) {
      throw std::invalid_argument("a pose has more or fewer joints than there are speeds");
    }
  }
  if (std::any_of(speeds.begin(), speeds.end(), [](double s) { return !(s > 0.0); })) {
    throw std::invalid_argument("the speed of a joint is not positive");
  }
  const auto time = [&](int a, int b) {
    return detail::move_time(places[static_cast<std::size_t>(a)],
                             places[static_cast<std::size_t>(b)], speeds);
  };
  std::vector<int> order = poses;
  for (auto here = order.begin(); here != order.end() && here + 1 != order.end(); ++here) {
    const int from = *here;
    std::iter_swap(here + 1, std::min_element(here + 1, order.end(), [&](int a, int b) {
                     return time(from, a) < time(from, b);
                   }));
  }
  constexpr double kShorter = 1e-9;  // seconds
  for (bool improved = true; improved;) {
    improved = false;
    for (std::size_t i = 1; i + 1 < order.size(); ++i) {
      for (std::size_t end = i + 2; end <= order.size(); ++end) {
        const double after = end < order.size()
                                 ? time(order[i - 1], order[end - 1]) + time(order[i], order[end])
                                 : time(order[i - 1], order[end - 1]);
        const double now = end < order.size()
                               ? time(order[i - 1], order[i]) + time(order[end - 1], order[end])
                               : time(order[i - 1], order[i]);
        if (!(after < now - kShorter)) continue;
        std::reverse(order.begin() + static_cast<std::ptrdiff_t>(i),
                     order.begin() + static_cast<std::ptrdiff_t>(end));
        improved = true;
      }
    }
  }
  return motion_time(places, order, speeds) <= motion_time(places, poses, speeds) ? order : poses;
}

}  // namespace kinecal
