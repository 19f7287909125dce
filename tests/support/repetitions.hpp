// How often a test repeats what it does, less with sanitizers, which are slow; and how many successes
// chance allows.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

#if defined(__SANITIZE_ADDRESS__)
#define KINECAL_HAS_SANITIZERS 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define KINECAL_HAS_SANITIZERS 1
#endif
#endif

namespace kinecal::test {

/// True where memory is watched.
#ifdef KINECAL_HAS_SANITIZERS
inline constexpr bool kHasSanitizers = true;
#else
inline constexpr bool kHasSanitizers = false;
#endif

/// The number of repetitions: `full`; `few` with sanitizers.  KINECAL_REPETITIONS replaces either by a
/// number, at most `full`.
inline int repetitions(int full, int few) {
  if (const char* given = std::getenv("KINECAL_REPETITIONS")) {
    return std::clamp(std::atoi(given), 1, full);
  }
  return kHasSanitizers ? std::min(few, full) : full;
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
