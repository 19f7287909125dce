// How thoroughly unknown poses are searched for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace kinecal {

/// How a search for unknown poses goes: see fit_frames.hpp.
struct PoseSearch {
  int starts = 60;           ///< orientations a round; with all rounds at most 300
  int rounds = 5;            ///< at most; the search ends once five fits are at the lowest minimum
  int first = 6;             ///< iterations of every start
  std::size_t kept = 15;     ///< starts of a round that go on, the best
  std::size_t finished = 4;  ///< fits that are solved with everything free, the best
  bool plain = true;         ///< solves from the configured pose, too
};

/// For fits that are compared with each other, not kept: a tenth of the time.
inline constexpr PoseSearch kQuickSearch{
    .starts = 20, .rounds = 1, .first = 3, .kept = 5, .finished = 1, .plain = false};

}  // namespace kinecal
