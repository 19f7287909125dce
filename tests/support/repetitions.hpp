// How often a test repeats what it does: less with sanitizers, which are slow.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdlib>

#if defined(__SANITIZE_ADDRESS__)
#define KINECAL_HAS_SANITIZERS 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define KINECAL_HAS_SANITIZERS 1
#endif
#endif

namespace kinecal::test {

/// The number of repetitions: `full`; `few` with sanitizers.  KINECAL_REPETITIONS replaces either by a
/// number, at most `full`.
inline int repetitions(int full, int few) {
  if (const char* given = std::getenv("KINECAL_REPETITIONS")) {
    return std::clamp(std::atoi(given), 1, full);
  }
#ifdef KINECAL_HAS_SANITIZERS
  return std::min(few, full);
#else
  (void)few;
  return full;
#endif
}

}  // namespace kinecal::test
