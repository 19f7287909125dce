// How often a test repeats what it does, less with sanitizers and without optimization, which are slow; and how
// many successes chance allows.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace kinecal::test {

/// True where sanitizers watch the libraries.
inline constexpr bool kHasSanitizers = KINECAL_SANITIZERS_IN_LIBRARIES;
/// True where tests take many times as long as in a release.  Tests themselves are not optimized anywhere.
inline constexpr bool kIsSlow = kHasSanitizers || !KINECAL_LIBRARIES_ARE_OPTIMIZED;

/// The number of repetitions: `full`; `few` where tests are slow.  KINECAL_REPETITIONS replaces either by a
/// number, at most `full`.
inline int repetitions(int full, int few) {
  if (const char* given = std::getenv("KINECAL_REPETITIONS")) {
    return std::clamp(std::atoi(given), 1, full);
  }
  return kIsSlow ? std::min(few, full) : full;
}

/// The number of repetitions of a study: `few`, unless KINECAL_REPETITIONS asks for more, at most `full`.
inline int repetitions_of_study(int full, int few) {
  return std::getenv("KINECAL_REPETITIONS") != nullptr ? repetitions(full, few) : few;
}

/// The counts that chance allows.
struct Band {
  int least = 0, most = 0;
  [[nodiscard]] bool contains(int count) const { return least <= count && count <= most; }
};

/// How many of n repetitions succeed if each does so with probability p: the binomial distribution
/// without its tails.  The fewer repetitions, the wider: few can refute little.
/// @param tail  probability of fewer than `least`, and of more than `most`
inline Band binomial_band(int n, double p, double tail) {
  const auto probability = [&](int k) {
    return std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) +
                    k * std::log(p) + (n - k) * std::log1p(-p));
  };
  Band band{0, n};
  for (double below = probability(0); below < tail; below += probability(band.least)) ++band.least;
  for (double above = probability(n); above < tail; above += probability(band.most)) --band.most;
  return band;
}

}  // namespace kinecal::test
