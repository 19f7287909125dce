// Medians of interleaved rounds: each round times every method once, so that a disturbance of the
// machine affects all methods alike.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

namespace kinecal::bench {

struct Timed {
  std::function<void()> work;
  double seconds = 0.0;  ///< of one call, the median over the rounds
};

[[nodiscard]] inline double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Seconds per call, averaged over `calls`.
[[nodiscard]] inline double seconds_of(const std::function<void()>& work, long calls) {
  const auto start = std::chrono::steady_clock::now();
  for (long i = 0; i < calls; ++i) work();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return seconds.count() / double(calls);
}

/// Number of calls that take the given time; also warms up.
[[nodiscard]] inline long calls_for(const std::function<void()>& work, double at_least) {
  long calls = 1;
  for (double each = seconds_of(work, calls); each * double(calls) < at_least;
       each = seconds_of(work, calls)) {
    calls = std::max(2 * calls, static_cast<long>(1.1 * at_least / each));
  }
  return calls;
}

/// Times all methods; the results are in Timed::seconds.
/// @param at_least  seconds for which each method runs in each round
inline void time_interleaved(std::vector<Timed>& all, int rounds, double at_least = 0.02) {
  std::vector<long> calls;
  for (const Timed& one : all) calls.push_back(calls_for(one.work, at_least));
  std::vector<std::vector<double>> seconds(all.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      seconds[i].push_back(seconds_of(all[i].work, calls[i]));
    }
  }
  for (std::size_t i = 0; i < all.size(); ++i) all[i].seconds = median(std::move(seconds[i]));
}

}  // namespace kinecal::bench
